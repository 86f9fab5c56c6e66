"""Methods that several studies share: meshes, repairs, fractions and measures of alternatives."""

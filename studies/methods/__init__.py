"""Methods that several studies use: meshes, repairs, fractions and measures of the alternatives."""

"""The paper's claims and our own, measured: one module per experiment, tables out."""

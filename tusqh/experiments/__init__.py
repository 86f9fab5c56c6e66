"""The paper's claims as experiments: arrays in, tables out."""

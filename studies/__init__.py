"""The studies of the paper and our own studies; each module makes tables that decide claims."""

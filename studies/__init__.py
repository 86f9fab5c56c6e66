"""The studies of the paper and our own: each module makes tables that decide claims."""

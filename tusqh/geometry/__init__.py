"""Outlines as they are: reading them and measuring (never repairing) their defects."""

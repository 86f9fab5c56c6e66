"""Contacts between materials, each decided by its own vote, in one conforming mesh."""

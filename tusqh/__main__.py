"""Run the command line as ``python -m tusqh``."""

from tusqh.cli import main

main()

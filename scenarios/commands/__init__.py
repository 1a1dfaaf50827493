"""Subcommands of `foreride`, one per module, each with `add(subparsers)` and the function it runs."""

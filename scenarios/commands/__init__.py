"""The subcommands of `foreride`, one a file: each offers `add(subparsers)` and the function it runs."""

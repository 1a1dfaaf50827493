"""From boxes and ego motion to the road height ahead of each wheel, with its uncertainty."""

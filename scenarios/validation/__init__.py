"""Validation against independent references, run by `foreride validation`."""

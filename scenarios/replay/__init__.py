"""Replay: recordings of images and vehicle signals through detector and estimator, without a simulator."""

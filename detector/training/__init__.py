"""Training: target assignment, losses, schedule, distillation and the training loop."""

"""From an estimate of the car's state and a preview of the road to damper commands."""

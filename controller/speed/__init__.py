"""Speed planning: the speed of the car over the road ahead, for ride comfort against trip time."""

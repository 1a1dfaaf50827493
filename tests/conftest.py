"""Common test configuration: hypothesis without deadlines, which a busy machine would miss.

The profile `mutation` draws the same examples each time and does not look for the smallest failing one.
"""

import os

from hypothesis import Phase, settings

settings.register_profile("foreride", deadline=None)
settings.register_profile(
    "mutation", deadline=None, derandomize=True, phases=[Phase.explicit, Phase.generate], max_examples=30
)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "foreride"))

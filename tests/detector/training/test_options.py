"""Test of the options of `foreride detector train`."""

from foreride.detector.training.options import SHIPPED, parser


def test_training_can_start_from_the_shipped_weights_wherever_foreride_is_installed() -> None:
    asked = parser(None).parse_args(["--data", "d", "--out", "o", "--init", "shipped"])
    assert asked.init == SHIPPED
    assert SHIPPED.is_file()

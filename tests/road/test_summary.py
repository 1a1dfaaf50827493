import pytest

from foreride.road.features.feature import HalfSineBump, Pothole
from foreride.road.road import Road
from foreride.road.roughness.iri import iri
from foreride.road.roughness.iso8608 import Roughness, rough_surface
from foreride.road.summary import list_features, summarise_track

BUMP = HalfSineBump(60.0, 0.08, 0.4, y_min_m=0.0)


def test_bump_counts_in_the_iri_of_its_track_and_not_in_the_class():
    road = Road(300.0, (BUMP,), Roughness("B", 2))
    left, right = summarise_track(road, 0.75), summarise_track(road, -0.75)
    assert left.iso_class == right.iso_class == "B"
    assert left.iri_m_km > right.iri_m_km + 0.3
    assert left.range_m > 0.07
    z = rough_surface(Roughness("B", 2), 300.0).height([0.05 * k for k in range(100, 6000)], -0.75)
    assert right.iri_m_km == pytest.approx(iri(z, 0.05), rel=1e-6)


def test_what_is_too_short_or_smooth_has_no_number():
    facts = summarise_track(Road(80.0, (BUMP,)), 0.75)
    assert facts.iri_m_km > 0
    assert facts.iso_class is facts.waviness is None
    assert summarise_track(Road(14.0), 0.0).iri_m_km is None
    assert summarise_track(Road(3.0), 0.0).range_m == 0


def test_features_are_listed_with_their_dimensions():
    facts = list_features(Road(80.0, (BUMP, Pothole(10.0, 0.05, 0.5, 0.4))))
    assert [fact["kind"] for fact in facts] == ["pothole", "half_sine_bump"]
    assert facts[1] == {**facts[1], "start_m": 60.0, "end_m": 60.4, "height_m": 0.08}

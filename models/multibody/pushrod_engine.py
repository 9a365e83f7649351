"""The whole valve train of Qin and Zuo 2000, section 1: single trains on one shaft, for its torsion."""

from collections.abc import Sequence

from ..valve_train.cams.law import LAW
from ..valve_train.cams.profile import CamProfile
from .mechanism import Mechanism
from .pushrod_train import PushrodTrain
from .shaft import SegmentedShaft


def pushrod_engine(
    shaft: SegmentedShaft, trains: Sequence[PushrodTrain], speed: float, profile: CamProfile = LAW
) -> Mechanism:
    """The trains on a shaft that is driven at its first station with a constant speed (rad/s).

    Each train stands at the station of its `place`, and its cam's phase is that of its tappet. Every segment
    of the shaft turns in a bearing, so that it twists but does not bend.
    """
    cams = [shaft.find_segment(train.place) for train in trains]
    pairs = list(zip(trains, cams, strict=True))
    return Mechanism(
        [*shaft.list_bodies(speed), *(body for train in trains for body in train.list_bodies())],
        [
            *shaft.list_bearings(),
            shaft.drive(speed),
            *(joint for train, cam in pairs for joint in train.list_joints(cam)),
        ],
        [*shaft.list_beams(), *(force for train, cam in pairs for force in train.list_forces(cam))],
        profile=profile,
    )

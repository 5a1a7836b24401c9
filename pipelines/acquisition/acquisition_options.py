"""Settings of the acquisition, as printed and at its best."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class HypothesizeAndTestOptions:
    """Algorithm 1 of Pesce et al. 2019.

    Attributes
    ----------
    set_size : int
        n: matches in the initial consensus set.
    share_to_accept : float
        n_lim over the number of image points.
    most_hypotheses : int
        t_lim as a count, so that a result does not depend on the machine: about two
        seconds of EPnP.
    screen_gates : float
        A set whose fourth match lies further than this many D_m from where the other three bring
        it is not solved; 0 solves all.
    seed : tuple of int
        Keys the draws, with the frame's number.
    """

    set_size: int = 4
    share_to_accept: float = 0.6
    most_hypotheses: int = 20_000
    screen_gates: float = 4.0
    seed: tuple[int, ...] = (0,)


@dataclass(frozen=True)
class TripleSearchOptions:
    """The exhaustive search over landmark triples.

    Attributes
    ----------
    appendage_triples, whole_triples : int
        Image triples tried, with the landmarks of T and with all of them.
    confirming_triples : int
        Image triples that are tried at least, so that a rival pose has its chance to show.
    pool : int
        Poses of an image triple that are refined.
    vote_sigmas : float
        A landmark votes for a pose that brings it this near to a point, fading outwards.
    gate_sigmas : float
        A refined pose matches within this distance.
    least_matches : int
    share_of_points, share_of_landmarks : float
        Of the image points, and of the landmarks that the pose shows, matched at least.
    margin : float
        Log-likelihood by which a pose must beat every other.
    """

    appendage_triples: int = 6
    whole_triples: int = 10
    confirming_triples: int = 2
    pool: int = 96
    vote_sigmas: float = 12.0
    gate_sigmas: float = 4.0
    least_matches: int = 7
    share_of_points: float = 0.6
    share_of_landmarks: float = 0.6
    margin: float = 20.0

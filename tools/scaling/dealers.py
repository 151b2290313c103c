"""How rank 0 deals out work: apps/relume/ranks/sample_dealer.cpp and frame_dealer.cpp, for samples that do not adapt."""

import collections
import dataclasses
import math

BLOCK_SAMPLES = 4
LEAST_BLOCKS = 4
LEAST_LAST_DEAL_S = 1.0
PARTS_PER_RANK = 2


def blocks_of(samples):
    return -(-samples // BLOCK_SAMPLES)


@dataclasses.dataclass
class Deal:
    number: int
    count: int  # samples
    workers: dict  # rank -> start
    rendered: bool = False  # whether its result is on its way


class SampleDealer:
    """Deals that take about `target_s` at the measured speed of their rank, and become smaller towards the end. Idle
    ranks then get the deal of a slow rank again, if they will be faster."""

    def __init__(self, samples, ranks, target_s):
        self.left = samples  # not dealt
        self.missing = samples  # not done
        self.ranks = ranks
        self.target_s = target_s
        self.add_s = 0.0  # for which rank 0 adds a result; 0: unknown
        self.sample_s = [0.0] * ranks  # seconds per sample; 0: unknown
        self.flights = {}  # number -> deal
        self.dealt = 0

    def next(self, rank, now):
        """The next deal of a rank; None: none for now."""
        if self.missing == 0:
            return None
        if self.left == 0:
            return self._late(rank, now)
        self.dealt += 1
        deal = Deal(self.dealt, min(self._blocks_for(rank) * BLOCK_SAMPLES, self.left), {rank: now})
        self.left -= deal.count
        self.flights[deal.number] = deal
        return deal

    def _blocks_for(self, rank):
        if self.sample_s[rank] <= 0:
            return LEAST_BLOCKS
        block_s = self.sample_s[rank] * BLOCK_SAMPLES
        wanted = max(int(min(self.target_s / block_s, 1e6)), LEAST_BLOCKS)
        last = math.ceil(min(max(LEAST_LAST_DEAL_S, self.ranks * self.add_s) / block_s, LEAST_BLOCKS))
        share = blocks_of(self.left) // (PARTS_PER_RANK * self.ranks)
        return max(min(wanted, share), last)

    def _late(self, rank, now):
        own_s = self.sample_s[rank]
        if own_s <= 0:
            return None
        latest, latest_s = None, 0.0
        for deal in self.flights.values():
            if deal.rendered or len(deal.workers) != 1:
                continue
            (worker, start), = deal.workers.items()
            elapsed = now - start
            expected = self.sample_s[worker] * deal.count
            left_s = expected - elapsed if expected > elapsed else elapsed
            if left_s > own_s * deal.count and left_s > latest_s:
                latest, latest_s = deal, left_s
        if latest:
            latest.workers[rank] = now
        return latest

    def counts(self, number):
        """Whether the result of a deal would be its first."""
        return number in self.flights

    def added(self, seconds):
        self.add_s = 0.5 * (self.add_s + seconds) if self.add_s > 0 else seconds

    def finished(self, rank, number, count, seconds):
        """Notes the result of a deal of `count` samples. Returns the ranks that still render it, which are free; None if
        it does not count."""
        if seconds > 0:
            now = seconds / count
            self.sample_s[rank] = 0.5 * (self.sample_s[rank] + now) if self.sample_s[rank] > 0 else now
        deal = self.flights.get(number)
        if not deal:
            return None
        self.missing -= deal.count
        deal.workers.pop(rank, None)
        del self.flights[number]
        return list(deal.workers)


class FrameDealer:
    """Segments of frames, which become shorter towards the end. Idle ranks then get missing frames again."""

    def __init__(self, frames, ranks, longest):
        self.frames, self.ranks, self.longest = frames, ranks, max(longest, 1)
        self.next_frame = 0
        self.received = [False] * frames
        self.missing = frames
        self.before = 0  # frames before the first one that is missing
        self.flights = collections.deque()  # [rank, first, count, again]

    def next(self, rank):
        """(first frame, number of frames) for a rank; None: none for now."""
        left = self.frames - self.next_frame
        if left > 0:
            if self.next_frame - self.before >= 2 * self.ranks * self.longest:
                return None
            count = min(max(left // (PARTS_PER_RANK * self.ranks), 1), self.longest)
            segment = (self.next_frame, count)
            self.next_frame += count
            self.flights.append([rank, *segment, False])
            return segment
        for flight in self.flights:
            if flight[3]:
                continue
            missing = [i for i in range(flight[1], flight[1] + flight[2]) if not self.received[i]]
            if not missing:
                continue
            flight[3] = True
            segment = (missing[0], flight[1] + flight[2] - missing[0])
            self.flights.append([rank, *segment, True])
            return segment
        return None

    def note(self, frame):
        """Notes an image. Returns whether it is the first of its frame."""
        if self.received[frame]:
            return False
        self.received[frame] = True
        self.missing -= 1
        while self.before < self.frames and self.received[self.before]:
            self.before += 1
        return True

    def finished(self, rank):
        self.flights = collections.deque(f for f in self.flights if f[0] != rank)

"""Ranks of one start of `mpirun -n N relume render`, their messages and rank 0, as apps/relume/ranks implements them."""

import collections
import dataclasses

from events import Clock, Coordinator, SharedLink

# Constants of apps/relume/ranks.
SUM_BYTES = 80  # of a pixel in a result, without layers of surfaces: message_bytes()
IMAGE_SUM_BYTES = 144  # of a pixel at rank 0: sizeof(PixelSums)
FRAME_BYTES = 12  # of a pixel of a frame: three floats
SMALL_BYTES = 256 << 10  # kSmallBytes: larger messages wait for a grant of rank 0
RECEIVE_BYTES = 256 << 20  # kReceiveBytes: limit of granted messages
LOST_AFTER_S = 20.0  # kLostAfter_s
COORDINATOR_LOST_AFTER_S = 30.0
ABANDON_S = 3.0  # RankLink::abandon()
POLL_S = 3e-3  # kIdlePause: the mean wait is half of it at the sender, and half of it at the receiver

STATES = ("start", "render", "again", "copy", "answer", "none", "end", "lost")


@dataclasses.dataclass(frozen=True)
class Job:
    name: str
    pixels: int
    samples: int  # per pixel and frame
    frames: int = 0  # 0: a still image
    warmup: int = 0  # frames rendered before a segment


@dataclasses.dataclass(frozen=True)
class Costs:
    samples_per_s: float  # camera samples of one rank
    plane_s: float  # per pixel: one core prepares a result, or adds it to the sums
    bandwidth: float  # bytes per second into rank 0
    latency_s: float
    cores: int = 1  # of a rank
    merge_cores: float = 1  # that adding a result uses at most
    launch_s: float = 0.0
    launch_per_rank_s: float = 0.0
    load_s: float = 0.0
    checkpoint_s: float = 0.0  # per pixel: one core writes a checkpoint
    write_s: float = 0.0  # per pixel: one core writes an image
    interval_s: float = 60.0  # --checkpoint-interval
    slowdown: float = 0.0  # of all ranks by each further rank on the same machine
    spread: float = 0.0  # standard deviation of the logarithm of ranks' speeds

    @property
    def merge_s(self):
        return self.plane_s / min(self.cores, self.merge_cores)


@dataclasses.dataclass
class Outcome:
    """`accounts`: seconds of all ranks by state; `network`, `coordinator`: busy seconds of rank 0; `memory`: the largest
    number of bytes of sums and results at rank 0 at a time."""

    ranks: int
    seconds: float = 0.0
    accounts: dict = dataclasses.field(default_factory=lambda: dict.fromkeys(STATES, 0.0))
    network: float = 0.0
    coordinator: float = 0.0
    memory: int = 0
    restarts: int = 0

    def share(self, *states):
        return sum(self.accounts[s] for s in states) / (self.ranks * self.seconds)

    @property
    def idle(self):
        """Share of ranks that neither render nor prepare a result."""
        return 1 - self.share("render", "again", "copy")


class Rank:
    def __init__(self, index, speed):
        self.index, self.speed = index, speed
        self.state, self.since = "start", 0.0
        self.work = 0  # number of the present work; events of earlier work are void
        self.ready = self.busy = self.lost = False
        self.unsent = False  # whether a large message waits or is being sent
        self.start = self.end = 0.0  # of the work

    def enter(self, state, now, outcome):
        outcome.accounts[self.state] += now - self.since
        self.state, self.since = state, now


class Launch:
    """One start of mpirun, until the job is complete or a rank is lost."""

    def __init__(self, job, costs, speeds, outcome, losses):
        self.job, self.costs, self.outcome = job, costs, outcome
        self.clock = Clock()
        self.network = SharedLink(self.clock, costs.bandwidth)
        self.coordinator = Coordinator(self.clock, self.deal_to_idle, self.turn, len(speeds))
        self.ranks = [Rank(i, s) for i, s in enumerate(speeds)]
        self.ended = False
        self.problem = False
        self.ending = False
        self.held = 0  # bytes of results at rank 0
        self.requests = collections.deque()  # large messages that wait for a grant
        self.granted = 0  # bytes of those that are granted and not handled
        start_s = costs.launch_s + costs.launch_per_rank_s * len(speeds) + costs.load_s
        for rank in self.ranks:
            self.clock.at(start_s + (0 if rank.index == 0 else self.delay_s()), lambda r=rank: self.hello(r))
        for time, index in losses:
            self.clock.at(time, lambda i=index: self.lose(self.ranks[i]))

    def run(self):
        self.clock.run(lambda: self.ended)
        for rank in self.ranks:
            rank.enter(rank.state, self.clock.now, self.outcome)
        self.outcome.seconds += self.clock.now
        self.outcome.network += self.network.busy_s
        self.outcome.coordinator += self.coordinator.busy_s

    def delay_s(self):
        """Of a small message."""
        return self.costs.latency_s + POLL_S

    def hold(self, size):
        self.held += size
        self.outcome.memory = max(self.outcome.memory, self.held + self.base_bytes())

    def hello(self, rank):
        if rank.lost:
            return

        def handle():
            rank.ready = True
            rank.enter("answer", self.clock.now, self.outcome)

        self.coordinator.deliver(lambda: 0.0, handle)

    def receive_limit(self):
        return RECEIVE_BYTES

    def send_to_coordinator(self, rank, size, cost, handle, sent=lambda: None):
        """Calls `sent()` when all bytes have left the rank. Messages of other ranks that are large wait for a grant."""
        is_large = rank.index > 0 and size > SMALL_BYTES

        def release():
            self.hold(-size)
            if is_large:
                self.granted -= size
                self.grant()

        def arrived():
            sent()
            if rank.lost or self.ranks[0].lost:
                release()
            else:
                self.coordinator.deliver(cost, lambda: (handle(), release()))

        def begin():
            self.hold(size)
            self.network.send(size, arrived)

        if rank.index == 0:
            self.hold(size)
            arrived()
        elif is_large:
            self.clock.after(self.delay_s(), lambda: (self.requests.append((rank, size, begin)), self.grant()))
        else:
            self.clock.after(self.delay_s(), begin)

    def grant(self):
        """Large messages in the order of their headers, within the limit. One that exceeds it is granted alone."""
        while self.requests:
            rank, size, begin = self.requests[0]
            if self.granted > 0 and self.granted + size > self.receive_limit():
                return
            self.requests.popleft()
            if not rank.lost:
                self.granted += size
                self.clock.after(self.delay_s(), begin)

    def send_to_rank(self, rank, action):
        self.clock.after(0 if rank.index == 0 else self.delay_s(), lambda: rank.lost or self.ended or action())

    def start_work(self, rank, samples):
        """Renders samples per pixel; then calls rendered()."""
        rank.work += 1
        rate = self.costs.samples_per_s * rank.speed / (1 + self.costs.slowdown * (len(self.ranks) - 1))
        rank.start = self.clock.now
        rank.end = rank.start + samples * self.job.pixels / rate
        rank.enter("render", self.clock.now, self.outcome)
        self.when_rendered(rank, rank.work)

    def when_rendered(self, rank, work):
        def check():
            if work != rank.work or rank.lost:
                return
            if self.clock.now < rank.end:  # other work of rank 0 has delayed it
                self.when_rendered(rank, work)
            else:
                self.rendered(rank)

        self.clock.at(rank.end, check)

    def slow_rank_0(self, core_seconds):
        """Other threads of rank 0 take processors from its render."""
        if self.ranks[0].state == "render":
            self.ranks[0].end += core_seconds / self.costs.cores

    def lose(self, rank):
        if self.ended or rank.lost:
            return
        rank.lost = True
        self.discard(rank)
        rank.enter("lost", self.clock.now, self.outcome)
        if rank.index == 0:
            self.coordinator.box.clear()
            self.clock.after(COORDINATOR_LOST_AFTER_S, self.end_without_rank_0)
        else:
            self.clock.after(LOST_AFTER_S, self.notice)

    def discard(self, rank):
        """Counts the render in progress as one without a result."""
        if rank.state == "render":
            self.count_again(self.clock.now - rank.start)

    def count_again(self, seconds):
        self.outcome.accounts["render"] -= seconds
        self.outcome.accounts["again"] += seconds

    def notice(self):
        self.problem = True
        self.coordinator.wake()

    def end_after(self, seconds):
        """Rank 0 writes while all others wait."""
        self.ending = True
        for rank in self.ranks:
            if not rank.lost:
                self.discard(rank)
                rank.enter("end", self.clock.now, self.outcome)
            rank.work += 1

        def end():
            self.ended = self.ended or not self.ranks[0].lost

        self.clock.after(seconds, end)

    def turn(self):
        """Ends, saves and deals."""
        if self.ended or self.ending or self.ranks[0].lost:
            return
        if self.complete() or self.problem:
            self.end_after(self.final_s() + (0 if self.complete() else ABANDON_S))
            return
        self.deal_to_idle()
        self.save_if_due()

    def deal_to_idle(self):
        if self.ended or self.ending or self.problem or self.ranks[0].lost:
            return
        for rank in self.ranks:
            if rank.ready and not rank.lost and self.is_idle(rank):
                self.deal(rank)

    def is_idle(self, rank):
        return not rank.busy

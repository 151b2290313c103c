"""The frames of a sequence on ranks."""

from dealers import FrameDealer
from launch import FRAME_BYTES, Launch

# Constants of apps/relume/ranks/frame_job.cpp.
WAITING_BYTES, LONGEST_SEGMENT = 2 << 30, 64


class Sequence(Launch):
    """apps/relume/ranks/frame_job.cpp."""

    def __init__(self, job, costs, speeds, outcome, losses, left):
        longest = WAITING_BYTES // (FRAME_BYTES * job.pixels) // (2 * len(speeds))
        self.dealer = FrameDealer(left, len(speeds), min(max(longest, 1), LONGEST_SEGMENT))
        self.first = job.frames - left
        self.written = 0
        self.left = left
        super().__init__(job, costs, speeds, outcome, losses)
        for rank in self.ranks:
            rank.queue = []  # messages that its link sends one after another
            rank.waits = False  # whether a rendered image waits for the link
            rank.position = 0 if self.first == 0 else None

    def base_bytes(self):
        return 0

    def complete(self):
        return self.dealer.missing == 0

    def final_s(self):
        self.left = self.dealer.frames - self.written
        return 0.0

    def end_without_rank_0(self):
        self.left = self.dealer.frames - self.written
        self.ended = True

    def save_if_due(self):
        """The checkpoint of a sequence is a number, written with each image."""

    def deal(self, rank):
        segment = self.dealer.next(rank.index)
        if not segment:
            if rank.state != "none":
                rank.enter("none", self.clock.now, self.outcome)
            return
        rank.busy = True
        if rank.state == "none":
            rank.enter("answer", self.clock.now, self.outcome)
        self.send_to_rank(rank, lambda: self.begin(rank, *segment))

    def begin(self, rank, first, count):
        continues = rank.position == first
        warmup = 0 if continues else min(self.first + first, self.job.warmup)
        rank.frame, rank.segment_end = first - warmup, first + count
        rank.shown = first
        self.start_work(rank, self.job.samples)

    def rendered(self, rank):
        if rank.frame < rank.shown:
            self.count_again(self.clock.now - rank.start)  # it only warms techniques up
            self.proceed(rank)
        elif rank.unsent:
            rank.waits = True
            rank.enter("answer", self.clock.now, self.outcome)
        else:
            self.send_image(rank)

    def send_image(self, rank):
        frame = rank.frame
        rank.unsent = rank.index > 0
        self.send(rank, FRAME_BYTES * self.job.pixels, lambda: self.cost_of(frame), lambda: None)
        self.proceed(rank)

    def proceed(self, rank):
        rank.frame += 1
        if rank.frame < rank.segment_end:
            self.start_work(rank, self.job.samples)
            return
        rank.position = rank.frame
        rank.enter("answer", self.clock.now, self.outcome)
        self.send(rank, 0, lambda: 0.0, lambda: self.done(rank))

    def send(self, rank, size, cost, handle):
        """Messages of a rank keep their order, so at most an image and `done` wait."""
        rank.queue.append((size, cost, handle))
        if len(rank.queue) == 1:
            self.send_next(rank)

    def send_next(self, rank):
        size, cost, handle = rank.queue[0]
        self.send_to_coordinator(rank, size, cost, handle, lambda: self.sent(rank, size))

    def sent(self, rank, size):
        rank.queue.pop(0)
        if size > 0:
            rank.unsent = False
        if rank.lost or self.ending:
            return
        if rank.queue:
            self.send_next(rank)
        if rank.waits and not rank.unsent:
            rank.waits = False
            self.send_image(rank)

    def cost_of(self, frame):
        """Writes the frames that are next."""
        if not self.dealer.note(frame):
            return 0.0
        self.hold(FRAME_BYTES * self.job.pixels)
        count = self.dealer.before - self.written
        self.written = self.dealer.before
        self.hold(-FRAME_BYTES * self.job.pixels * count)
        self.slow_rank_0(count * self.job.pixels * self.costs.write_s)
        return count * self.job.pixels * self.costs.write_s

    def done(self, rank):
        rank.busy = False
        self.dealer.finished(rank.index)

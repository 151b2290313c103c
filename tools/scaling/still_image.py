"""The samples of a still image on ranks."""

from dealers import SampleDealer
from launch import IMAGE_SUM_BYTES, RECEIVE_BYTES, SUM_BYTES, Launch

# Constants of apps/relume/ranks/sample_coordinator.cpp.
LONGEST_DEAL_S, SHORTEST_DEAL_S, DEALS_PER_INTERVAL = 10.0, 0.5, 4
RECEIVED_SUMS = 2
WAITING_RESULTS = 1


class StillImage(Launch):
    """apps/relume/ranks/sample_coordinator.cpp and sample_worker.cpp."""

    def __init__(self, job, costs, speeds, outcome, losses, left):
        target_s = min(max(costs.interval_s / DEALS_PER_INTERVAL, SHORTEST_DEAL_S), LONGEST_DEAL_S)
        self.dealer = SampleDealer(left, len(speeds), target_s)
        self.left = left  # samples that the checkpoint lacks
        self.saved_s = 0.0
        self.saving = False
        super().__init__(job, costs, speeds, outcome, losses)
        for rank in self.ranks:
            rank.deal = None  # what it renders, as rank 0 knows
            rank.pending = set()  # numbers of rendered deals without a result at rank 0
            rank.renders = None  # what it renders
            rank.next_deal = None  # what it renders once its result is handed over
            rank.result = None  # (deal, seconds) that its link does not have
        self.clock.at(costs.interval_s, self.coordinator.wake)

    def base_bytes(self):
        return IMAGE_SUM_BYTES * self.job.pixels

    def receive_limit(self):
        return max(RECEIVE_BYTES, RECEIVED_SUMS * IMAGE_SUM_BYTES * self.job.pixels)

    def complete(self):
        return self.dealer.missing == 0

    def final_s(self):
        """The last checkpoint and the image."""
        unsaved = self.dealer.missing < self.left
        self.left = self.dealer.missing
        return self.job.pixels * ((self.costs.checkpoint_s if unsaved else 0) + self.costs.write_s)

    def end_without_rank_0(self):
        self.ended = True

    def is_idle(self, rank):
        return not rank.deal and len(rank.pending) <= WAITING_RESULTS

    def deal(self, rank):
        deal = self.dealer.next(rank.index, self.clock.now)
        if not deal:
            if rank.state != "none" and not rank.pending:
                rank.enter("none", self.clock.now, self.outcome)
            return
        rank.deal = deal
        if rank.state == "none":
            rank.enter("answer", self.clock.now, self.outcome)
        self.send_to_rank(rank, lambda: self.begin(rank, deal))

    def begin(self, rank, deal):
        if rank.deal is not deal:
            return
        if rank.result:
            rank.next_deal = deal
            return
        rank.renders = deal
        self.start_work(rank, deal.count)

    def rendered(self, rank):
        deal, seconds = rank.renders, self.clock.now - rank.start
        rank.renders, rank.result = None, (deal, seconds)
        self.send_to_coordinator(rank, 0, lambda: 0.0, lambda: self.note_rendered(rank, deal))
        if rank.unsent:
            rank.enter("answer", self.clock.now, self.outcome)
        else:
            self.prepare(rank)

    def note_rendered(self, rank, deal):
        """The rank may get its next deal while its result is on its way."""
        if rank.deal is deal:
            deal.rendered = True
            rank.pending.add(deal.number)
            rank.deal = None

    def prepare(self, rank):
        rank.enter("copy", self.clock.now, self.outcome)
        (deal, seconds), work = rank.result, rank.work

        def prepared():
            if rank.work != work or rank.lost:
                return
            rank.result, rank.unsent = None, rank.index > 0
            rank.enter("answer", self.clock.now, self.outcome)
            self.send_to_coordinator(rank, SUM_BYTES * self.job.pixels, lambda: self.cost_of(deal),
                                     lambda: self.merge(rank, deal, seconds), lambda: self.sent(rank))
            if rank.next_deal:
                deal_then, rank.next_deal = rank.next_deal, None
                self.begin(rank, deal_then)

        self.clock.after(self.job.pixels * self.costs.plane_s, prepared)

    def sent(self, rank):
        rank.unsent = False
        if rank.result and not rank.lost and not self.ending:
            self.prepare(rank)

    def cost_of(self, deal):
        if not self.dealer.counts(deal.number):
            return 0.0
        self.slow_rank_0(self.job.pixels * self.costs.plane_s)
        return self.job.pixels * self.costs.merge_s

    def merge(self, rank, deal, seconds):
        rank.pending.discard(deal.number)
        if rank.deal is deal:
            rank.deal = None
        if self.dealer.counts(deal.number):
            self.dealer.added(self.job.pixels * self.costs.merge_s)
        late = self.dealer.finished(rank.index, deal.number, deal.count, seconds)
        if late is None:
            self.count_again(seconds)
            return
        for index in late:
            self.cancel(self.ranks[index], deal)

    def cancel(self, rank, deal):
        if rank.lost or rank.deal is not deal:
            return
        rank.deal = None

        def stop():
            if rank.next_deal is deal:
                rank.next_deal = None
            if rank.renders is not deal or rank.state != "render":
                return
            rank.work += 1
            rank.renders = None
            rank.enter("answer", self.clock.now, self.outcome)
            self.count_again(self.clock.now - rank.start)

        self.send_to_rank(rank, stop)

    def save_if_due(self):
        """Copies the sums; another thread writes them."""
        due = self.clock.now - self.saved_s >= self.costs.interval_s and self.dealer.missing < self.left
        if self.saving or not due:
            return
        self.saving, self.saved_s = True, self.clock.now
        missing, copy_s = self.dealer.missing, self.job.pixels * self.costs.plane_s
        write_s = self.job.pixels * self.costs.checkpoint_s
        self.slow_rank_0(copy_s + write_s)

        def saved():
            if self.ranks[0].lost:
                return
            self.saving = False
            self.left = min(self.left, missing)
            self.clock.at(self.saved_s + self.costs.interval_s, self.coordinator.wake)

        self.clock.after(copy_s + write_s, saved)
        self.coordinator.work(copy_s)

"""Discrete events: a clock, a link that transfers share, and the thread of rank 0 that handles messages.

The events are a heap of the standard library. Debian 12 has SimPy 2.3.1, whose interface SimPy 3 replaced.
"""

import collections
import heapq
import math


class Clock:
    def __init__(self):
        self.now = 0.0
        self.heap = []
        self.count = 0  # events of equal time happen in the order of their calls

    def at(self, time, action):
        self.count += 1
        heapq.heappush(self.heap, (max(time, self.now), self.count, action))

    def after(self, seconds, action):
        self.at(self.now + seconds, action)

    def run(self, ended):
        """Runs events until `ended()`. Fails if none is left before."""
        while not ended():
            if not self.heap:
                raise RuntimeError("the simulated job waits for an event that never comes")
            self.now, _, action = heapq.heappop(self.heap)
            action()


class SharedLink:
    """The network link of rank 0. Transfers under way share its bandwidth equally, because rank 0 takes one chunk of
    each rank in turn."""

    def __init__(self, clock, bytes_per_s):
        self.clock, self.rate = clock, bytes_per_s
        self.served = 0.0  # bytes that a transfer has got since the start
        self.last = 0.0
        self.flows = []
        self.version = 0
        self.busy_s = 0.0

    def send(self, size, arrived):
        if math.isinf(self.rate) or size == 0:
            self.clock.after(0, arrived)
            return
        self._advance()
        self.version += 1
        heapq.heappush(self.flows, (self.served + size, self.version, arrived))
        self._schedule()

    def _advance(self):
        elapsed = self.clock.now - self.last
        self.last = self.clock.now
        if self.flows:
            self.served += elapsed * self.rate / len(self.flows)
            self.busy_s += elapsed

    def _schedule(self):
        self.version += 1
        if self.flows:
            version = self.version
            left_s = (self.flows[0][0] - self.served) * len(self.flows) / self.rate
            self.clock.after(left_s, lambda: self._finish(version))

    def _finish(self, version):
        if version != self.version:
            return
        self._advance()
        _, _, arrived = heapq.heappop(self.flows)
        self._schedule()
        arrived()


class Coordinator:
    """The thread of rank 0 that handles messages one by one. It deals after each, and calls `turn` when no message waits
    or after `most` messages."""

    def __init__(self, clock, deal, turn, most):
        self.clock, self.deal, self.turn, self.most = clock, deal, turn, most
        self.box = collections.deque()
        self.handled = 0  # messages since the last turn
        self.busy = False
        self.busy_s = 0.0

    def deliver(self, cost, handle):
        """`cost()`: seconds of this thread before `handle()`."""
        self.box.append((cost, handle))
        if not self.busy:
            self._next()

    def wake(self):
        if not self.busy:
            self.turn()

    def work(self, seconds):
        """Keeps the thread busy; messages wait."""
        self.busy = True
        self.busy_s += seconds
        self.clock.after(seconds, self._next)

    def _next(self):
        self.busy = False
        if not self.box or self.handled == self.most:
            self.handled = 0
            self.turn()
            if self.busy or not self.box:
                return
        self.handled += 1
        cost, handle = self.box.popleft()
        seconds = cost()
        self.busy = True
        self.busy_s += seconds
        self.clock.after(seconds, lambda: self._handled(handle))

    def _handled(self, handle):
        handle()
        self.deal()
        self._next()

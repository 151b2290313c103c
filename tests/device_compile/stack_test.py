#!/usr/bin/env python3
"""Stack that a thread of each kernel needs on a device. RELUME_PTX: the device code; RELUME_CLANG_VERSION: of its
compiler; RELUME_CXXFILT: demangles its names. RELUME_PTXAS: CUDA's assembler, if it is compared too, for the GPUs of
RELUME_ARCHITECTURE and the kernels of RELUME_PART, "index/count"; RELUME_KERNEL_RESOURCES: the file for its table of
registers, stacks and spills, which the test also prints."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(FOLDER), str(FOLDER.parent / "ptx" / "translator")]

from assembler_report import Usage, parse_report, spilling, table
from device_module import device_module, device_text
from parser import parse
from split_ptx import split
from stack_sizes import stack_sizes

# Bytes. A GPU reserves the largest stack for each thread that it can hold: 270,000 on one with 132 multiprocessors.
LIMIT = 4096
# Upper bounds of kernels with large stacks, in bytes, in the PTX of clang 14. The first pattern that fits a type
# counts; others need at most OTHERS. The design plans at most 1.2 KB for a path: 0.5 KB for a surface point with eight
# lobes, 0.2 KB for the path's state and random numbers, the rest along the calls that sample and evaluate the point.
# Path graphs need 0.9 KB more, with their vertices. Learning from paths with a cache adds the recorders, 0.4 KB.
BOUNDS = (
    (r"FeatureKernel|MeasureEdgesKernel", 2800),  # surface points of the pixel, its mirror image and its reflection
    # A filtered vertex beside both subpaths, and 0.6 KB for records of the path: samples, and states of chains.
    (r"(BidirectionalKernel|MergingKernel)<LearningContext, SubpathCells>", 3250),
    (r"(BidirectionalKernel|MergingKernel)<BdptContext, SubpathCells>", 2450),
    # A sample of indirect light beside both subpaths: 0.2 KB.
    (r"(BidirectionalKernel|MergingKernel)<LearningContext, SubpathSamples>", 3250),
    (r"(BidirectionalKernel|MergingKernel)<BdptContext, SubpathSamples>", 2450),
    # Samples and cells.
    (r"(BidirectionalKernel|MergingKernel)<LearningContext, SampledSubpathCells>", 3400),
    (r"(BidirectionalKernel|MergingKernel)<BdptContext, SampledSubpathCells>", 2600),
    (r"(BidirectionalKernel|MergingKernel)<LearningContext", 3050),
    (r"LightSubpathKernelOf<LearningContext", 2000),
    (r"BidirectionalKernel|LightSubpathKernel|MergingKernel", 2250),
    # Receivers of the pixel, and of its history or a neighbour.
    (r"TemporalReuseKernel|SpatialReuseKernel|IndirectTemporalKernel|IndirectSpatialKernel", 2750),
    (r"IndirectValidationKernel", 1350),
    (r"PathTemporalKernel|PathSpatialKernel", 2150),  # a path, its surface point and sampler, beside two reservoirs
    # A path, beside the chosen one; with a path graph, or the state of a path that ends in cells. Choices that learn add
    # the recorders of samples and of both kinds of chains: 0.7 KB.
    (r"PathCandidateKernel<LearnedChoices, GraphSuffix>", 3250),
    (r"PathCandidateKernel<LearnedChoices, SharcSuffix>", 2700),
    (r"PathCandidateKernel<LearnedChoices", 2500),
    (r"PathCandidateKernel<FixedChoices, GraphSuffix>", 2800),
    (r"PathCandidateKernel<FixedChoices, SharcSuffix>", 2000),
    (r"PathCandidateKernel", 1800),
    (r"PathPairKernel", 1600),
    (r"PathKernel<RadianceOutput, CachedRecordingOutput, (FirstScatterOutput, )?IndirectSampleOutput", 1500),
    (r"PathKernel<RadianceOutput, IndirectSampleOutput", 1350),
    # Recorders of both kinds of chains and of samples, and the policies of all other outputs.
    (r"PathKernel<RadianceOutput, (Cached)?RecordingOutput, ChainOutput", 1900),
    # Indirect samples beside first vertices, and optional outputs.
    (r"PathKernel<RadianceOutput, CachedRecordingOutput, OptionalOutput", 1600),
    (r"PathKernel<RadianceOutput, ChainOutput, OptionalOutput", 1750),
    # The recorders of both kinds of chains: 0.3 KB.
    (r"PathKernel<RadianceOutput, ChainOutput", 1650),
    (r"RisKernel", 1600),
    (r"CellUpdateKernel", 1750),  # vertices of the path
    # Path graphs also store units of samples for reservoirs: 0.03 KB.
    (r"PathKernel<CellsOutput<PathGraphContext>", 2150),
    (r"PathKernel<CellsOutput<", 1450),
    # Recorders of samples and of both kinds of chains, here and below: 0.4 KB.
    # With samples for reservoirs, here and below: 0.1 KB.
    (r"PathKernel<CachedRecordingOutput, CachedChainOutput, CellsOutput<PathGraphContext>, IndirectSampleOutput", 2750),
    (r"PathKernel<CachedRecordingOutput, CachedChainOutput, VerifiedCellsOutput<PathGraphContext>, IndirectSampleOutput", 2800),
    (r"PathKernel<CachedRecordingOutput, CachedChainOutput, IndirectSampleOutput", 2050),
    (r"PathKernel<CachedRecordingOutput, CachedChainOutput, RadianceOutput, .*IndirectSampleOutput", 1900),
    (r"PathKernel<CachedRecordingOutput, CachedChainOutput, CellsOutput<PathGraphContext>", 2700),
    (r"PathKernel<CachedRecordingOutput, CachedChainOutput, CellsOutput<", 1950),
    (r"PathKernel<CachedRecordingOutput, CachedChainOutput, RadianceOutput, .*CellEnds", 1950),
    (r"PathKernel<VerifiedCellsOutput<PathGraphContext>", 2200),  # and an evaluation for mirror reflection
    (r"PathKernel<VerifiedCellsOutput<", 1450),
    (r"PathKernel<CachedRecordingOutput, CachedChainOutput, VerifiedCellsOutput<PathGraphContext>", 2750),
    (r"PathKernel<CachedRecordingOutput, CachedChainOutput, VerifiedCellsOutput<", 2000),
    (r"PathKernel<RadianceOutput> ", 1229),  # the limit of the design
    (r"PathKernel<", 1450),
    (r"DepthVoteKernel|FirstLight(OfCells)?Kernel", 1550),
    (r"IncidentLightKernel", 1300),
    (r"ResolveCellsKernel", 1300),  # a surface point of an edge ray, beside the cells of a pixel
    (r"RecordSamplesKernel", 1200),
    (r"TraceGradientsKernel", 1300),
)
OTHERS = 1100
# Other versions of the compiler inline other functions.
SLACK = 1 if os.environ["RELUME_CLANG_VERSION"].startswith("14.") else 1.25
# The assembler may align frames, and stores the registers that each call of a chain must keep: up to 17 % more on sm_75,
# in chains of ten calls. It may keep some variables in registers.
ASSEMBLER_MOST_SHARE = 1.2
ASSEMBLER_LEAST_SHARE = 0.75
# Bytes that the instructions of a function may store, because the registers of a thread do not suffice, and as many
# that they may load again. What that costs has not been measured on a GPU.
MOST_SPILLED = 1024

HEADER = """.version 6.3
.target sm_75
.address_size 64
"""
MODULE = HEADER + """.func leaf() { .local .align 8 .b8 a[20]; ret; }
.func middle() { .local .align 1 .b8 a[1]; .local .align 4 .b8 b[8]; call.uni leaf, (); ret; }
.func shallow() { .local .align 4 .b8 a[4]; ret; }
.visible .entry k() { .local .align 4 .b8 a[100]; call.uni shallow, (); call.uni middle, (); ret; }
.visible .entry none() { ret; }
"""
RECURSION = HEADER + """.func f() { call.uni f, (); ret; }
.visible .entry k() { call.uni f, (); ret; }
"""
INDIRECT_CALL = HEADER + """.func f() { ret; }
.visible .entry k() { .reg .b64 %rd<2>; mov.u64 %rd1, f; call.uni %rd1, (); ret; }
"""

REPORT = """ptxas info    : 0 bytes gmem, 4096 bytes cmem[3]
ptxas info    : Compiling entry function '_Z1k' for 'sm_75'
ptxas info    : Function properties for _Z1k
    1152 bytes stack frame, 96 bytes spill stores, 120 bytes spill loads
ptxas info    : Used 255 registers, used 1 barriers, 1184 bytes cumulative stack size, 368 bytes cmem[0]
ptxas info    : Compiling entry function '_Z4none$' for 'sm_75'
ptxas info    : Function properties for _Z4none$
    8 bytes stack frame, 0 bytes spill stores, 0 bytes spill loads
ptxas info    : Used 8 registers, 368 bytes cmem[0]
ptxas info    : Function properties for _Z4leaf
    32 bytes stack frame, 4 bytes spill stores, 0 bytes spill loads
"""


def demangled(names):
    text = "\n".join(names) + "\n"
    command = [os.environ["RELUME_CXXFILT"]]
    lines = subprocess.run(command, input=text, check=True, capture_output=True, text=True).stdout
    return [line.replace("relume::", "") for line in lines.splitlines()]


def assembler_report(text):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "part.ptx"
        path.write_text(text, encoding="utf-8")
        command = [os.environ["RELUME_PTXAS"], f"-arch={os.environ['RELUME_ARCHITECTURE']}", "-v", path, "-o", os.devnull]
        return subprocess.run(command, check=True, capture_output=True, text=True).stderr


def bound_of(kernel):
    return min(SLACK * next((bound for pattern, bound in BOUNDS if re.search(pattern, kernel)), OTHERS), LIMIT)


class Chains(unittest.TestCase):
    def test_the_deepest_chain_of_calls_counts(self):
        chains = stack_sizes(parse(MODULE, "module.ptx"))
        self.assertEqual(chains["k"].frames, (("k", 100), ("middle", 12), ("leaf", 20)))
        self.assertEqual((chains["k"].size, chains["none"].size), (132, 0))

    def test_recursion_is_refused(self):
        with self.assertRaisesRegex(ValueError, "'f' calls itself"):
            stack_sizes(parse(RECURSION, "module.ptx"))

    def test_calls_of_addresses_are_refused(self):
        with self.assertRaisesRegex(ValueError, "line 5 calls a function by its address"):
            stack_sizes(parse(INDIRECT_CALL, "module.ptx"))


class Parts(unittest.TestCase):
    def test_parts_have_each_entry_once_and_what_it_calls(self):
        parts = [stack_sizes(parse(part, "part.ptx")) for part in split(MODULE, 2)]
        self.assertEqual(sorted(name for part in parts for name in part), ["k", "none"])
        self.assertEqual({name: chain for part in parts for name, chain in part.items()},
                         stack_sizes(parse(MODULE, "module.ptx")))

    def test_parts_lack_functions_that_they_do_not_call(self):
        without, = [part for part in split(MODULE, 2) if ".entry none" in part]
        self.assertNotIn(".func", without)


class Report(unittest.TestCase):
    def test_kernels_have_registers_and_the_stack_of_their_calls(self):
        kernels, functions = parse_report(REPORT)
        self.assertEqual(kernels, {"_Z1k": Usage(255, 1184, 96, 120), "_Z4none$": Usage(8, 8, 0, 0)})
        self.assertEqual(functions, {"_Z4leaf": Usage(0, 32, 4, 0)})

    def test_the_table_begins_with_the_largest_stack(self):
        lines = table({**parse_report(REPORT)[0], **parse_report(REPORT)[1]}, str.upper).splitlines()
        self.assertEqual(lines[1], "      255    1184            96          120  _Z1K")
        self.assertEqual(lines[2], "               32             4            0  _Z4LEAF")
        self.assertEqual(len(lines), 4)

    def test_functions_that_spill_more_than_a_bound_are_found(self):
        kernels, functions = parse_report(REPORT)
        self.assertEqual(spilling({**kernels, **functions}, 120), {})
        self.assertEqual(spilling({**kernels, **functions}, 119), {"_Z1k": kernels["_Z1k"]})
        self.assertEqual(set(spilling({**kernels, **functions}, 3)), {"_Z1k", "_Z4leaf"})

    def test_a_kernel_without_registers_is_refused(self):
        with self.assertRaisesRegex(ValueError, "no registers of '_Z4none"):
            parse_report(REPORT.replace("Used 8 registers", ""))


class Stack(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.text = device_text()
        chains = stack_sizes(device_module())
        cls.kernels = dict(zip(chains, demangled(chains)))
        cls.chains = chains

    def test_no_kernel_needs_more_than_its_bound(self):
        excess = []
        for name, chain in self.chains.items():
            if chain.size > bound_of(self.kernels[name]):
                frames = zip(demangled(f for f, _ in chain.frames), chain.frames)
                excess.append(f"{chain.size}: " + " > ".join(f"{f[:60]} {size}" for f, (_, size) in frames))
        self.assertEqual(excess, [], "more stack than before")

    def test_bounds_are_within_the_limit_and_name_kernels(self):
        self.assertLessEqual(max(bound for _, bound in BOUNDS), LIMIT)
        for pattern, _ in BOUNDS:
            self.assertTrue(any(re.search(pattern, k) for k in self.kernels.values()), pattern)

    @unittest.skipUnless(os.environ.get("RELUME_PTXAS"), "without CUDA's assembler")
    def test_the_assembler_needs_as_much(self):
        index, count = map(int, os.environ["RELUME_PART"].split("/"))
        part = split(self.text, count)[index]
        kernels, functions = parse_report(assembler_report(part))
        self.write_table({**kernels, **functions})
        found = {name: usage.stack for name, usage in kernels.items()}
        expected = stack_sizes(parse(part, "part.ptx"))
        self.assertEqual(expected, {name: self.chains[name] for name in expected}, "the part lacks calls")
        self.assertEqual(set(found), set(expected))
        more = {self.kernels[n]: (size, self.chains[n].size) for n, size in found.items()
                if size > self.chains[n].size * ASSEMBLER_MOST_SHARE}
        self.assertEqual(more, {}, "the chains lack calls")
        large = [n for n in expected if any(re.search(pattern, self.kernels[n]) for pattern, _ in BOUNDS)]
        less = {self.kernels[n]: (found[n], self.chains[n].size) for n in large
                if found[n] < ASSEMBLER_LEAST_SHARE * self.chains[n].size}
        self.assertEqual(less, {}, "the report lacks sizes, or the chains have too much")
        self.assertEqual(spilling({**kernels, **functions}, MOST_SPILLED), {}, "registers do not suffice")

    @staticmethod
    def write_table(usages):
        titles = dict(zip(usages, demangled(usages)))
        text = table(usages, titles.get)
        print(text)
        if file := os.environ.get("RELUME_KERNEL_RESOURCES"):
            pathlib.Path(file).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    unittest.main()

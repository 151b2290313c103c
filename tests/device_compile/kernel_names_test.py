"""Tests of the names of kernels that are read from symbols."""

import unittest

from kernel_names import compiled_kernels, launched_kernels

SYMBOLS = """
0000000000000000 t bool relume::launch_on_device<relume::Sum<relume::View<float> > >(relume::Backend&, relume::Tile const&)
0000000000000000 t bool relume::launch_on_device<relume::(anonymous namespace)::Fill>(relume::Backend&)
0000000000000000 W bool relume::launch<relume::(anonymous namespace)::Fill>(relume::Backend&)
0000000000000000 W void relume::device::run<relume::Copy>(unsigned int)
0000000000000000 W void relume::device::run_group<relume::Sort>(unsigned int)
"""


class KernelNames(unittest.TestCase):
    def test_launches_are_found_where_launch_itself_is_inlined(self):
        names = {"relume::Sum<relume::View<float> >", "relume::(anonymous namespace)::Fill"}
        self.assertEqual(launched_kernels(SYMBOLS), names)

    def test_entries_of_both_kinds_are_found(self):
        self.assertEqual(compiled_kernels(SYMBOLS), {"relume::Copy", "relume::Sort"})


if __name__ == "__main__":
    unittest.main()

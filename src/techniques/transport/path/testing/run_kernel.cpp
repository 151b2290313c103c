#include "techniques/transport/path/testing/run_kernel.h"

namespace relume::testing {

template std::vector<uint32_t> trace_pixels(const CompiledScene&, const TraceSettings&, const RadianceOutput&);
template std::vector<uint32_t> trace_pixels(const CompiledScene&, const TraceSettings&, const RadianceOutput&,
                                            const FirstVertexOutput&);
template std::vector<uint32_t> trace_pixels(const CompiledScene&, const TraceSettings&, const RadianceOutput&,
                                            const SpecularOutput&);

}  // namespace relume::testing

//! What all headers of mechanisms share, each piece once in a translation unit and in headers that need it.
//!
//! The pieces are C, C++, CUDA and OpenCL C at once; `host.h` and `opencl.h` say what differs.

use crate::optimise::Completion;

use super::{Dialect, Header};

/// What a header begins with.
pub(super) fn text(header: &Header<'_>) -> String {
    let functions = || header.walk.functions.iter().map(|(_, function)| function);
    let solves = functions().any(|function| function.completion == Completion::Solve);
    let is_constrained = header.walk.constrained().is_some();
    let checks_inertia = header.derivation.requirements.iter().any(|requirement| requirement.condition.count() > 1);
    let pieces = [
        (header.dialect == Dialect::Cpp, "#include <array>\n#include <stdexcept>\n#include <string>\n"),
        (header.dialect != Dialect::OpenCl, include_str!("prelude/host.h")),
        (header.dialect == Dialect::OpenCl, include_str!("prelude/opencl.h")),
        (header.walk.library_sines, "#ifndef MBS_LIBRARY_TRIGONOMETRY\n#define MBS_LIBRARY_TRIGONOMETRY\n#endif\n"),
        (true, include_str!("prelude/numbers.h")),
        (true, include_str!("prelude/sin_cos.h")),
        (!header.has_kernels(), include_str!("prelude/lockstep.h")),
        (true, include_str!("prelude/check.h")),
        (checks_inertia, include_str!("prelude/check_inertia.h")),
        (solves, include_str!("prelude/ldlt.h")),
        (!header.walk.names.splines.is_empty(), include_str!("prelude/spline.h")),
        (is_constrained, include_str!("prelude/scaling.h")),
        (is_constrained, include_str!("prelude/constrained.h")),
        (is_constrained, include_str!("prelude/solution.h")),
        (header.has_kernels(), include_str!("prelude/kernel.h")),
    ];
    pieces.iter().filter(|(is_needed, _)| *is_needed).map(|(_, text)| *text).collect()
}

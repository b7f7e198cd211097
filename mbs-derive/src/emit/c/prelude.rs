//! What all headers of mechanisms share, each piece once in a translation unit and in headers that need it.
//!
//! The pieces are C, C++, CUDA and OpenCL C at once; `host.h` and `opencl.h` say what differs.

use crate::optimise::Completion;

use super::super::Language;

use super::{Dialect, Header};

const OF_CPP: &str = "#include <array>\n#include <stdexcept>\n#include <string>\n";

/// What a header begins with.
pub(super) fn text(header: &Header<'_>) -> String {
    let functions = || header.walk.functions.iter().map(|(_, function)| function);
    let solves = functions().any(|function| function.completion == Completion::Solve);
    let is_constrained = header.walk.constrained().is_some();
    let checks_inertia = header.derivation.requirements.iter().any(|requirement| requirement.condition.count() > 1);
    let pieces = [
        (header.dialect == Dialect::Cpp, OF_CPP),
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

/// All pieces of headers in a language, in their order; with kernels angles are not in lockstep.
pub(in crate::emit) fn shared(language: Language) -> Vec<&'static str> {
    let has_kernels = matches!(language, Language::Cuda | Language::Opencl);
    let first =
        if language == Language::Opencl { include_str!("prelude/opencl.h") } else { include_str!("prelude/host.h") };
    let pieces = [
        if language == Language::Cpp { OF_CPP } else { "" },
        first,
        include_str!("prelude/numbers.h"),
        include_str!("prelude/sin_cos.h"),
        if has_kernels { "" } else { include_str!("prelude/lockstep.h") },
        include_str!("prelude/check.h"),
        include_str!("prelude/check_inertia.h"),
        include_str!("prelude/ldlt.h"),
        include_str!("prelude/spline.h"),
        include_str!("prelude/scaling.h"),
        include_str!("prelude/constrained.h"),
        include_str!("prelude/solution.h"),
        if has_kernels { include_str!("prelude/kernel.h") } else { "" },
    ];
    pieces.into_iter().filter(|piece| !piece.is_empty()).collect()
}

//! `shape pose += box([x, y, z]);`: what bodies look like, for drawing alone.
//!
//! No pass of mechanics reads it: statements are gone through once without shapes, which is the mechanism, and once
//! more with them, where there are any. Frames and expressions that shapes alone need are those of the second time.

use crate::diagnostic::Code;
use crate::expr::{Expr, Symbol, evaluate};
use crate::model::check::sample::default_parameters;
use crate::model::lagrangian::Drawing;
use crate::model::value::Shape;
use crate::model::value::constant::Dependence;
use crate::model::value::dimension::Dimension;
use crate::model::value::evaluate::{Argument, Resolved, Resolver};
use crate::parse::syntax::{Declaration, Expression, Name, Span, Statement, StatementKind};

/// Shapes that one mechanism may have.
pub(in crate::model) const MAX_SHAPES: usize = 10_000;

/// Whether there are shapes to be drawn.
pub(in crate::model) fn has_shapes(declaration: &Declaration) -> bool {
    let mut waiting = vec![&declaration.imported[..], &declaration.statements[..]];
    while let Some(statements) = waiting.pop() {
        for Statement { kind, .. } in statements {
            match kind {
                StatementKind::Shape { .. } => return true,
                StatementKind::For { body, .. } | StatementKind::Part { body, .. } => waiting.push(body),
                StatementKind::If { branches, otherwise } => {
                    waiting.extend(branches.iter().map(|(_, body)| &body[..]).chain([&otherwise[..]]));
                }
                _ => {}
            }
        }
    }
    false
}

impl<'d, 'g> Resolver<'d, 'g> {
    /// `shape pose += kind(sizes);`, passed over unless shapes are drawn.
    pub(in crate::model) fn shape(
        &mut self,
        pose: &Expression,
        kind: &Name,
        file: Option<&str>,
        sizes: &[Expression],
        statement: &Span,
    ) -> Resolved<()> {
        if !self.draws {
            return Ok(());
        }
        let frame = self.argument(pose).and_then(|pose| self.frame(&pose));
        let given = self.arguments(sizes);
        let (kind, sizes) = match kind.text.as_str() {
            "box" => ("box", self.edges(kind, given?)?),
            "cylinder" => ("cylinder", self.lengths(kind, given?, &["radius", "length"])?),
            "sphere" => ("sphere", self.lengths(kind, given?, &["radius"])?),
            _ => ("mesh", self.scales(kind, given?)?),
        };
        let frame = frame?;
        if self.lagrangian.drawings.len() == MAX_SHAPES {
            let message = format!("this mechanism has more than {MAX_SHAPES} shapes");
            return Err(self.refuse(Code::TooMuch, statement, message, "draw fewer, or a mesh of many"));
        }
        let (place, _) = self.report.place(statement);
        let (on, file) = (pose.to_string(), file.map(str::to_string));
        self.lagrangian.drawings.push(Drawing { kind, file, sizes, frame, on, place });
        Ok(())
    }

    /// The edges of a box.
    fn edges(&mut self, kind: &Name, given: Vec<Argument<'g>>) -> Resolved<Vec<Expr<'g>>> {
        let form = "write `box([x, y, z])`, the lengths of its edges along the axes of the pose";
        self.check_count(kind, &given, 1..=1, form)?;
        let vector = self.vector(&given[0])?;
        self.check_dimension(vector.fit(), "the size of a box", Dimension::LENGTH, &given[0].span)?;
        self.checked(vector.components.0.to_vec(), "the edge of a box", "m", &given[0].span)
    }

    /// Numbers that are lengths, with their names.
    fn lengths(&mut self, kind: &Name, given: Vec<Argument<'g>>, names: &[&str]) -> Resolved<Vec<Expr<'g>>> {
        let form = format!("write `{}({})`", kind.text, names.join(", "));
        self.check_count(kind, &given, names.len()..=names.len(), &form)?;
        let mut lengths = Vec::new();
        for (argument, name) in given.iter().zip(names) {
            let what = format!("the {name} of a {}", kind.text);
            let length = self.of_dimension(argument, &what, Dimension::LENGTH)?;
            lengths.extend(self.checked(vec![length], &what, "m", &argument.span)?);
        }
        Ok(lengths)
    }

    /// The factors of a mesh along its axes: one for all, or three.
    fn scales(&mut self, kind: &Name, given: Vec<Argument<'g>>) -> Resolved<Vec<Expr<'g>>> {
        let form = "write `mesh(\"file.stl\")`, or `mesh(\"file.stl\", 1e-3)` of a file in millimetres";
        self.check_count(kind, &given, 0..=1, form)?;
        let what = "the scale of a mesh";
        match given.first() {
            None => Ok(vec![self.graph.integer(1); 3]),
            Some(argument) if argument.value.shape() == Shape::Number => {
                let factor = self.of_dimension(argument, what, Dimension::ONE)?;
                self.checked(vec![factor; 3], what, "", &argument.span)
            }
            Some(argument) => {
                let vector = self.vector(argument)?;
                self.check_dimension(vector.fit(), what, Dimension::ONE, &argument.span)?;
                self.checked(vector.components.0.to_vec(), what, "", &argument.span)
            }
        }
    }

    fn check_count(
        &mut self,
        kind: &Name,
        given: &[Argument<'g>],
        wanted: std::ops::RangeInclusive<usize>,
        form: &str,
    ) -> Resolved<()> {
        if wanted.contains(&given.len()) {
            return Ok(());
        }
        let number = match wanted.end() {
            1 => "one size".to_string(),
            n => format!("{n} sizes"),
        };
        let message = match kind.text.as_str() {
            "mesh" => format!("a mesh has a file and one scale, {} are given", given.len()),
            text => format!("a {text} has {number}, {} are given", given.len()),
        };
        Err(self.refuse(Code::ArgumentCount, &kind.span, message, form))
    }

    /// Sizes are made of constants and parameters, and greater than zero by their defaults.
    fn checked(&mut self, sizes: Vec<Expr<'g>>, what: &str, unit: &str, span: &Span) -> Resolved<Vec<Expr<'g>>> {
        let all = sizes.iter().map(|&e| self.known.facts.dependence(e)).fold(Dependence::default(), Dependence::or);
        if all.moves() || all.on(Dependence::RATE) {
            let help = "sizes are made of constants and parameters; what moves is the pose";
            return Err(self.refuse(Code::SizeOfAShape, span, format!("{what} does not change in time"), help));
        }
        let defaults = default_parameters(&self.lagrangian);
        let values = evaluate(&sizes, |symbol| match symbol {
            Symbol::Parameter(i) => defaults.get(i as usize).copied().unwrap_or(f64::NAN),
            _ => f64::NAN,
        });
        match values.into_iter().find(|value| !(*value > 0.0 && value.is_finite())) {
            Some(value) => {
                let message = format!("{what} is greater than zero, this is {}", format!("{value} {unit}").trim_end());
                Err(self.refuse(Code::SizeOfAShape, span, message, ""))
            }
            None => Ok(sizes),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::emit::Options;
    use crate::expr::{Graph, Symbol, evaluate};
    use crate::model::check::trial::refused;

    const ARM: &str = "\
        mechanism Arm {
            param m: kg = 2; param l: m = 0.5; param r: m = 0.02; const n = 2;
            coord q[n]: rad;
            gravity [0, 0, -9.81 m/s^2];
            part link(m, pose) { kinetic += rigid_body(m, [0, 0, -l/2], diag(1, 1, 1)*m*l^2/12, pose); /*1*/ }
            let mut hinge = world * rot_x(10*deg);
            for i in 0..n {
                hinge = hinge * rot_y(q[i]);
                reaction at_hinge[i] at hinge;
                link one[i](m, hinge);
                /*2*/
                hinge = hinge * translation([0, 0, -l]);
            }
            output tip = hinge;
        }";

    fn drawn() -> String {
        ARM.replace("/*1*/", "shape pose * translation([0, 0, -l/2]) += cylinder(r, l);")
            .replace("/*2*/", "shape hinge += sphere(2*r); if i == 1 { shape hinge*rot_x(q[0]) += mesh(\"a.stl\"); }")
    }

    #[test]
    fn shapes_change_no_byte_of_what_is_generated() {
        let code = |text: &str| crate::generate("arm.mbs", text, &Options::default()).expect("a mechanism").code;
        // The parameter `r` is there in both; nothing but shapes uses it.
        assert_eq!(code(ARM), code(&drawn()));
    }

    #[test]
    fn shapes_use_parameters_and_are_outputs_of_the_picture() {
        let (graph, text) = (Graph::verbatim(), drawn());
        let (lagrangian, warnings) = crate::declared(&text, &graph, &[]).expect("a mechanism");
        assert_eq!(warnings.iter().count(), 0, "{warnings:?}");
        let drawings = lagrangian.drawings();
        let shown: Vec<_> = drawings.iter().map(|d| (d.kind, d.on.as_str(), d.file.as_deref())).collect();
        let cylinder = ("cylinder", "pose*translation([0, 0, -l/2])", None);
        let sphere = ("sphere", "hinge", None);
        assert_eq!(shown, [cylinder, sphere, cylinder, sphere, ("mesh", "hinge*rot_x(q[0])", Some("a.stl"))]);
        let picture = lagrangian.pictured();
        let names: Vec<&str> = picture.outputs.iter().map(|output| output.name.as_str()).collect();
        let shapes: Vec<String> = (0..5).flat_map(|i| [format!("shape_{i}"), format!("shape_{i}_size")]).collect();
        let bodies: Vec<String> = (0..2).flat_map(|i| [format!("body_{i}"), format!("body_{i}_inertia")]).collect();
        let expected: Vec<&str> = ["tip"].into_iter().chain(shapes.iter().chain(&bodies).map(String::as_str)).collect();
        assert_eq!(names, expected);
        // The middle of the second link, both links hanging straight down but for the tilt of the base.
        let output = &picture.outputs[5];
        let place = evaluate(&output.value.components(&picture.frames), |symbol| match symbol {
            Symbol::Parameter(1) => 0.5,
            Symbol::Coordinate(_) => 0.0,
            _ => f64::NAN,
        });
        let (sine, cosine) = 10f64.to_radians().sin_cos();
        let expected = [0.0, 0.75 * sine, -0.75 * cosine];
        assert!(place.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{}: {place:?}", output.name);
        let code = crate::derived(&picture);
        assert!(code.named("shape_4").is_some() && code.named("body_1_inertia").is_some());
    }

    #[test]
    fn sizes_are_lengths_that_stay() {
        let on = |shape: &str| format!("let body = translation([x, 0, 0]); shape body += {shape};");
        refused(&on("sphere(m)"), "m: the radius of a sphere must be m, this is kg");
        refused(
            &on("box([1, 1, 1])"),
            "[1, 1, 1]: the size of a box must be m, this is a plain number; a number has no unit unless it is \
             written behind it: `0.3 kg`, `9.81 m/s^2`",
        );
        refused(&on("cylinder(l, -l)"), "-l: the length of a cylinder is greater than zero, this is -3 m");
        refused(&on("box([l, 0 m, l])"), "[l, 0 m, l]: the edge of a box is greater than zero, this is 0 m");
        refused(
            &on("mesh(\"a.stl\", l)"),
            "l: the scale of a mesh must be a plain number, this is m; divide by a quantity of the same dimension",
        );
        refused(&on("mesh(\"a.stl\", -1)"), "-1: the scale of a mesh is greater than zero, this is -1");
        refused(
            &on("sphere(l + x)"),
            "l + x: the radius of a sphere does not change in time; sizes are made of constants and parameters; what \
             moves is the pose",
        );
        refused(&on("sphere(l, l)"), "sphere: a sphere has one size, 2 are given; write `sphere(radius)`");
        refused(
            &on("box(l, l, l)"),
            "box: a box has one size, 3 are given; write `box([x, y, z])`, the lengths of its edges along the axes of the \
             pose",
        );
        refused(
            "shape [x, 0, 0] += sphere(l);",
            "[x, 0, 0]: expected a pose, found a vector; poses are made by `rot_z(angle)`, \
             `translation([x, y, z])`, `dh(theta, d, a, alpha)`",
        );
    }
}

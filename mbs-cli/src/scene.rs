//! What there is to see of a mechanism, and where it is at a state: for pictures of all kinds.
//!
//! - [`mesh`]: triangles of files.

pub(crate) mod mesh;

use mbs_derive::Analysis;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::Derivation;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// What there is to see, as [`Analysis::scene`] finds it, to be kept from call to call.
#[derive(Serialize, Deserialize)]
pub(crate) struct Scene {
    /// The programs of frames, bodies and places.
    pub(crate) derivation: Derivation,
    pub(crate) frames: usize,
    pub(crate) bodies: Vec<OfBody>,
    pub(crate) shapes: Vec<OfShape>,
    /// Names, empty where there is none.
    pub(crate) places: Vec<String>,
    pub(crate) links: Vec<[usize; 2]>,
    pub(crate) traced: Vec<usize>,
}

/// A body of a scene.
#[derive(Serialize, Deserialize)]
pub(crate) struct OfBody {
    /// The number of its frame.
    pub(crate) frame: usize,
    /// Whether it is a rigid body, no particle.
    pub(crate) is_rigid: bool,
    /// Whether shapes show it.
    pub(crate) has_shape: bool,
}

/// A shape of a scene.
#[derive(Serialize, Deserialize)]
pub(crate) struct OfShape {
    /// `box`, `cylinder`, `sphere` or `mesh`.
    pub(crate) kind: String,
    /// The file of a mesh, as written.
    pub(crate) file: Option<String>,
    /// Where the statement begins.
    pub(crate) place: usize,
    /// The number of its frame.
    pub(crate) frame: usize,
}

/// A body at a state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body {
    pub(crate) mass: f64,
    /// Its mass centre in the world.
    pub(crate) centre: Vector3<f64>,
    /// From its frame's axes to the world's.
    pub(crate) attitude: UnitQuaternion<f64>,
    /// About the mass centre, in its frame.
    pub(crate) inertia: Matrix3<f64>,
}

/// Everything at a state.
#[derive(Clone, Debug)]
pub(crate) struct Sight {
    pub(crate) bodies: Vec<Body>,
    pub(crate) places: Vec<Vector3<f64>>,
    pub(crate) shapes: Vec<Shape>,
}

/// A shape at a state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    /// The origin of its frame.
    pub(crate) centre: Vector3<f64>,
    pub(crate) attitude: UnitQuaternion<f64>,
    /// As declared; of a cylinder radius and length, of a mesh factors.
    pub(crate) sizes: Vector3<f64>,
}

/// Numbers of a body: mass, mass centre, inertia.
const BODY: usize = 10;

/// Numbers of a frame: position, rotation row by row.
const FRAME: usize = 12;

impl Scene {
    pub(crate) fn of(analysis: &Analysis<'_>) -> Self {
        let scene = analysis.scene();
        let bodies = scene.bodies.iter();
        let shapes = scene.shapes.into_iter();
        Scene {
            derivation: scene.derivation,
            frames: scene.frames,
            bodies: bodies
                .map(|body| OfBody { frame: body.frame, is_rigid: body.is_rigid, has_shape: body.has_shape })
                .collect(),
            shapes: shapes
                .map(|shape| OfShape {
                    kind: shape.kind.to_string(),
                    file: shape.file,
                    place: shape.place,
                    frame: shape.frame,
                })
                .collect(),
            places: scene.places,
            links: scene.links,
            traced: scene.traced,
        }
    }

    /// With these parameters, at any state.
    pub(crate) fn interpreter(&self, parameters: &[f64]) -> Interpreter<'_> {
        Interpreter::with_parameters(&self.derivation, parameters.to_vec())
    }

    /// What is seen at a state.
    pub(crate) fn at(&self, interpreter: &Interpreter<'_>, state: &State) -> Sight {
        let values = |name: &str| {
            self.derivation.named(name).map_or(Vec::new(), |function| interpreter.evaluate(function, state))
        };
        let [frames, bodies, places, sizes] = ["frames", "bodies", "places", "shapes"].map(values);
        let vector = |numbers: &[f64]| Vector3::new(numbers[0], numbers[1], numbers[2]);
        let pose = |number: usize| {
            let frame = &frames[FRAME * number..FRAME * (number + 1)];
            (vector(frame), Matrix3::from_row_slice(&frame[3..]))
        };
        let shape = |(own, shape): (&[f64], &OfShape)| {
            let (centre, rotation) = pose(shape.frame);
            Shape { centre, attitude: attitude(rotation), sizes: vector(own) }
        };
        let body = |(own, body): (&[f64], &OfBody)| {
            let (origin, rotation) = pose(body.frame);
            let [xx, yy, zz, xy, xz, yz] = [4, 5, 6, 7, 8, 9].map(|i| own[i]);
            Body {
                mass: own[0],
                centre: origin + rotation * vector(&own[1..]),
                attitude: attitude(rotation),
                inertia: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
            }
        };
        Sight {
            bodies: bodies.chunks_exact(BODY).zip(&self.bodies).map(body).collect(),
            places: places.chunks_exact(3).map(vector).collect(),
            shapes: sizes.chunks_exact(3).zip(&self.shapes).map(shape).collect(),
        }
    }
}

/// The rotation next to a matrix that is one but for rounding, and for the length of a quaternion.
fn attitude(rotation: Matrix3<f64>) -> UnitQuaternion<f64> {
    let x = rotation.column(0).normalize();
    let y = (rotation.column(1) - x * x.dot(&rotation.column(1))).normalize();
    let columns = Matrix3::from_columns(&[x, y, x.cross(&y)]);
    if columns.iter().all(|entry| entry.is_finite()) {
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(columns))
    } else {
        UnitQuaternion::identity()
    }
}

/// The half axes of the uniform ellipsoid with this mass and inertia, `a² = 5 (I₂ + I₃ − I₁)/2m`, and how it lies;
/// `None` of points.
pub(crate) fn ellipsoid(mass: f64, inertia: &Matrix3<f64>) -> Option<(Vector3<f64>, UnitQuaternion<f64>)> {
    let trace = inertia.trace();
    let is_solid = mass > 0.0 && trace > 0.0 && mass.is_finite() && inertia.iter().all(|entry| entry.is_finite());
    if !is_solid {
        return None;
    }
    let principal = inertia.symmetric_eigen();
    let axes = principal.eigenvalues.map(|own| (2.5 * (trace - 2.0 * own) / mass).max(0.0).sqrt());
    Some((axes, attitude(principal.eigenvectors)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box's ellipsoid has the moments of the box.
    #[test]
    fn ellipsoids_have_the_inertia_that_they_are_drawn_for() {
        let turn = UnitQuaternion::from_euler_angles(0.3, -0.8, 1.1).to_rotation_matrix();
        let inertia = turn * Matrix3::from_diagonal(&Vector3::new(2.0, 1.5, 1.8)) * turn.inverse();
        let (axes, lies) = ellipsoid(3.0, &inertia).unwrap();
        let moment = |i: usize| 3.0 / 5.0 * (axes[(i + 1) % 3].powi(2) + axes[(i + 2) % 3].powi(2));
        let own = Matrix3::from_diagonal(&Vector3::new(moment(0), moment(1), moment(2)));
        let lies = lies.to_rotation_matrix();
        assert!((lies * own * lies.inverse() - inertia).abs().max() < 1e-12);
        assert!(ellipsoid(0.0, &inertia).is_none());
        assert!(ellipsoid(1.0, &Matrix3::zeros()).is_none());
    }

    #[test]
    fn a_matrix_that_is_no_rotation_is_the_nearest_simple_one() {
        let turn = UnitQuaternion::from_euler_angles(0.3, -0.8, 1.1);
        let stretched = turn.to_rotation_matrix().into_inner() * 1.7;
        assert!(attitude(stretched).angle_to(&turn) < 1e-7);
        assert_eq!(attitude(Matrix3::zeros()), UnitQuaternion::identity());
    }
}

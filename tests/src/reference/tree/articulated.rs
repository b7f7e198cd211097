//! Forward dynamics by articulated bodies.
//!
//! # Source
//!
//! Featherstone, *Rigid Body Dynamics Algorithms*, 2008 (RBDA), table 7.1, and section 9.2 for the joints whose motion
//! is prescribed.

use super::super::rigid_body::{cross_force, cross_motion, spatial};
use super::{Motion, Node, Tree};
use nalgebra::{DMatrix, DVector, Matrix6, Matrix6xX, Vector3, Vector6};

/// What is known of a node before forces are: the transform from its parent, its free coordinates, its inertia and
/// forces of those beyond, in its own axes.
struct Articulated {
    /// Spatial motions from the axes of the parent.
    transform: Matrix6<f64>,
    /// Its free motions, those of `own` coordinates; none where it is prescribed.
    joint: Option<Joint>,
    /// `I`
    inertia: Matrix6<f64>,
    /// `p`
    wrench: Vector6<f64>,
    /// `c`, and what is known of `S ν̇`.
    bias: Vector6<f64>,
}

/// A joint with coordinates of its own: `ν̇ = P q̈` with P of full row rank.
struct Joint {
    /// Numbers of the coordinates.
    own: Vec<usize>,
    /// `S`
    subspace: Matrix6xX<f64>,
    /// `Pᵀ (P Pᵀ)⁻¹`, with which `q̈ = … ν̇` and `τ_ν = …ᵀ τ_q`.
    inverse: DMatrix<f64>,
}

/// `U = I S`, `D⁻¹ = (Sᵀ U)⁻¹`, `u = τ − Sᵀ p`.
struct Reduced {
    u: Matrix6xX<f64>,
    d_inverse: DMatrix<f64>,
    rest: DVector<f64>,
}

impl Tree {
    /// `q̈` under generalized forces, without ever forming `M`; the signals move as `xd` and `xdd` say, whose entries
    /// for the coordinates' accelerations are not read. Ball joints keep their unit length.
    ///
    /// `None` where joints share a coordinate, or a joint has two.
    pub fn articulated_bodies(&self, x: &[f64], xd: &[f64], xdd: &[f64], forces: &[f64]) -> Option<Vec<f64>> {
        let mut bodies = self.outward(x, xd, xdd)?;
        let mut reduced: Vec<Option<Reduced>> = Vec::new();
        for i in (0..bodies.len()).rev() {
            let Articulated { transform, mut inertia, mut wrench, bias, .. } = bodies[i];
            let joint = match &bodies[i].joint {
                Some(joint) => Some(self.reduce(&bodies[i], joint, forces)?),
                None => None,
            };
            if let Some(Reduced { u, d_inverse, rest }) = &joint {
                inertia -= u * d_inverse * u.transpose();
                wrench += u * d_inverse * rest;
            }
            reduced.push(joint);
            if let Some(parent) = self.nodes[i].parent {
                bodies[parent].inertia += transform.transpose() * inertia * transform;
                bodies[parent].wrench += transform.transpose() * (wrench + inertia * bias);
            }
        }
        reduced.reverse();
        Some(self.accelerations(x, xd, &bodies, &reduced))
    }

    /// Velocities, and with them `c = v × S ν` and `p = v ×* I v`.
    fn outward(&self, x: &[f64], xd: &[f64], xdd: &[f64]) -> Option<Vec<Articulated>> {
        let (transforms, inertias, map) = (self.motion_transforms(x), self.spatial_inertias(), self.rates(x));
        let joints = self.joints(&map)?;
        let nu = &map * DVector::from_column_slice(xd);
        let mut driven = DVector::from_column_slice(xdd);
        driven.rows_mut(0, self.coordinates).fill(0.0);
        let known = &map * driven + self.curvatures(xd);
        let mut velocities: Vec<Vector6<f64>> = Vec::new();
        let mut bodies = Vec::new();
        for (i, joint) in joints.into_iter().enumerate() {
            let (transform, inertia) = (transforms[i], inertias[i]);
            let along =
                |rates: &DVector<f64>| self.subspace(i).iter().map(|(k, s)| s * rates[*k]).sum::<Vector6<f64>>();
            let before = self.nodes[i].parent.map_or(Vector6::zeros(), |p| transform * velocities[p]);
            let velocity = before + along(&nu);
            let bias = cross_motion(&velocity) * along(&nu) + along(&known);
            let wrench = cross_force(&velocity) * inertia * velocity;
            velocities.push(velocity);
            bodies.push(Articulated { transform, joint, inertia, wrench, bias });
        }
        Some(bodies)
    }

    fn reduce(&self, body: &Articulated, joint: &Joint, forces: &[f64]) -> Option<Reduced> {
        let Joint { own, subspace, inverse } = joint;
        let u = body.inertia * subspace;
        let tau = inverse.transpose() * DVector::from_fn(own.len(), |k, _| forces[own[k]]);
        let drive = |k: usize| self.drives.get(own[k]).copied().unwrap_or(0.0);
        let drives = DMatrix::from_diagonal(&DVector::from_fn(own.len(), |k, _| drive(k)));
        let d = subspace.transpose() * &u + inverse.transpose() * drives * inverse;
        Some(Reduced { rest: tau - subspace.transpose() * body.wrench, d_inverse: d.try_inverse()?, u })
    }

    fn accelerations(&self, x: &[f64], xd: &[f64], bodies: &[Articulated], reduced: &[Option<Reduced>]) -> Vec<f64> {
        let base = spatial(Vector3::zeros(), -Vector3::from(self.gravity));
        let mut accelerations: Vec<Vector6<f64>> = Vec::new();
        let mut qdd = vec![0.0; self.coordinates];
        for (i, body) in bodies.iter().enumerate() {
            let above = self.nodes[i].parent.map_or(base, |p| accelerations[p]);
            let mut acceleration = body.transform * above + body.bias;
            if let (Some(Reduced { u, d_inverse, rest }), Some(joint)) = (&reduced[i], &body.joint) {
                let nu_dot = d_inverse * (rest - u.transpose() * acceleration);
                acceleration += &joint.subspace * &nu_dot;
                let own = &joint.inverse * nu_dot;
                joint.own.iter().zip(own.iter()).for_each(|(k, value)| qdd[*k] = *value);
            }
            accelerations.push(acceleration);
        }
        for first in self.balls() {
            // From |q|² = 1: q·q̈ = −|q̇|².
            let speed: f64 = xd[first..first + 4].iter().map(|c| c * c).sum();
            (first..first + 4).for_each(|k| qdd[k] -= speed * x[k]);
        }
        qdd
    }

    /// The free joint of each node. `None` where a joint shares a coordinate with another, or a hinge or slide has two.
    fn joints(&self, map: &DMatrix<f64>) -> Option<Vec<Option<Joint>>> {
        let mut taken = vec![false; self.coordinates];
        let mut joint = |(i, node): (usize, &Node)| -> Option<Option<Joint>> {
            let own: Vec<usize> = match &node.motion {
                Motion::Fixed => Vec::new(),
                Motion::Turn(_, law) | Motion::Slide(_, law) => {
                    law.terms.iter().map(|(k, _)| *k).filter(|k| *k < self.coordinates).collect()
                }
                Motion::Ball { first } => (*first..first + 4).collect(),
            };
            let several = own.len() > 1 && !matches!(node.motion, Motion::Ball { .. });
            let shared = own.iter().any(|k| std::mem::replace(&mut taken[*k], true));
            if several || shared {
                return None;
            }
            if own.is_empty() {
                return Some(None);
            }
            let (rows, columns): (Vec<usize>, Vec<Vector6<f64>>) = self.subspace(i).into_iter().unzip();
            let part = DMatrix::from_fn(rows.len(), own.len(), |row, k| map[(rows[row], own[k])]);
            let inverse = part.transpose() * (&part * part.transpose()).try_inverse()?;
            Some(Some(Joint { own, subspace: Matrix6xX::from_columns(&columns), inverse }))
        };
        self.nodes.iter().enumerate().map(&mut joint).collect()
    }
}

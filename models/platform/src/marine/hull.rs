//! Closed forms of the platform at rest: what it displaces, how stable it is, how long it swings.
//!
//! ```text
//! ρ ∇ = m,   KB, KG from the foot of the columns,   BM = I/∇,   GM = KB + BM − KG
//! c_z = ρ g A_w,   c_φ = ρ g ∇ GM_T,   c_θ = ρ g ∇ GM_L,   T = 2π √(M/c)
//! ```
//!
//! # Source
//! E. V. Lewis (ed.), *Principles of Naval Architecture*, vol. I, 1988, chapter II; natural periods: O. M. Faltinsen,
//! *Sea Loads on Ships and Offshore Structures*, 1990, chapter 3.

use core::f64::consts::PI;

use mbs_models::check::{Invalid, not_negative, positive};
use mbs_models::marine_platform::Params;
use mbs_runtime::Scalar;

use super::Four;

/// What follows from the parameters of a platform that floats upright.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hull {
    /// The parameters.
    pub params: Params,
    /// A_w, the sections of all columns \[m²\].
    pub waterplane: f64,
    /// Volume of the pontoons \[m³\].
    pub submerged: f64,
    /// ∇, the volume of the water that is displaced \[m³\].
    pub displacement: f64,
    /// How deep the lower ends of the columns are \[m\].
    pub draught: f64,
    /// GM_T for roll and GM_L for pitch \[m\].
    pub metacentric_heights: [f64; 2],
}

impl Hull {
    /// Of a platform with these parameters.
    ///
    /// # Errors
    /// [`Invalid`] where a mass, an inertia, a length or a stiffness is not positive or a damping negative, and where
    /// it does not float upright with its columns in the water: draught and metacentric heights are positive then.
    pub fn new(params: &Params) -> Result<Self, Invalid> {
        let p = *params;
        positive("m", p.m)?;
        positive("inertias", p.inertias)?;
        not_negative("added_mass", p.added_mass)?;
        not_negative("added_inertias", p.added_inertias)?;
        positive("column_radius", p.column_radius)?;
        positive("column_place", p.column_place)?;
        positive("pontoon", p.pontoon)?;
        positive("mass_centre", p.mass_centre)?;
        not_negative("heave_damping", p.heave_damping)?;
        not_negative("turn_damping", p.turn_damping)?;
        not_negative("heave_drag", p.heave_drag)?;
        not_negative("turn_drag", p.turn_drag)?;
        positive("mooring", p.mooring)?;
        positive("lift_place", p.lift_place)?;
        positive("lateral_place", p.lateral_place)?;
        positive("density", p.density)?;
        positive("g", p.g)?;
        let section = PI * p.column_radius * p.column_radius;
        let (waterplane, submerged) = (4.0 * section, 2.0 * p.pontoon.iter().product::<f64>());
        let displacement = p.m / p.density;
        let draught = (displacement - submerged) / waterplane;
        // From the lower ends of the columns up.
        let buoyancy = (waterplane * draught * 0.5 * draught - submerged * 0.5 * p.pontoon[2]) / displacement;
        let own = 0.25 * p.column_radius * p.column_radius;
        let metacentric_height =
            |place: f64| buoyancy + waterplane * (place * place + own) / displacement - p.mass_centre;
        let heights = [metacentric_height(p.column_place[1]), metacentric_height(p.column_place[0])];
        positive("draught of the columns afloat", draught)?;
        positive("metacentric height upright", heights)?;
        Ok(Self { params: p, waterplane, submerged, displacement, draught, metacentric_heights: heights })
    }

    /// c of heave \[N/m\], roll, pitch and yaw \[N·m\].
    #[must_use]
    pub fn stiffness(&self) -> Four {
        let Params { density, g, mooring, .. } = self.params;
        let [transverse, longitudinal] = self.metacentric_heights;
        let weight = density * g * self.displacement;
        [density * g * self.waterplane, weight * transverse, weight * longitudinal, mooring]
    }

    /// M of heave \[kg\], roll, pitch and yaw \[kg·m²\], added mass included.
    #[must_use]
    pub fn inertia(&self) -> Four {
        let Params { m, added_mass, inertias: own, added_inertias: added, .. } = self.params;
        [m + added_mass, own[0] + added[0], own[1] + added[1], own[2] + added[2]]
    }

    /// `2π √(M/c)`, without damping \[s\].
    #[must_use]
    pub fn natural_periods(&self) -> Four {
        let (inertia, stiffness) = (self.inertia(), self.stiffness());
        core::array::from_fn(|i| 2.0 * PI * Scalar::sqrt(inertia[i] / stiffness[i]))
    }

    /// How deep the lower ends of the columns are in still water \[m\]: ahead on the left and on the right, behind on
    /// the left and on the right.
    #[must_use]
    pub fn depths(&self, q: &Four) -> Four {
        let Params { column_place: [x, y], mass_centre, .. } = self.params;
        let ((roll, cos_roll), (pitch, cos_pitch)) = (Scalar::sin_cos(q[1]), Scalar::sin_cos(q[2]));
        // The vertical in the platform's axes.
        let up = [-pitch, cos_pitch * roll, cos_pitch * cos_roll];
        four([x, y]).map(|[x, y]| self.draught - mass_centre - q[0] - (up[0] * x + up[1] * y - up[2] * mass_centre))
    }

    /// How deep they are under a sea that is elevated so at a place \[m\].
    #[must_use]
    pub fn depths_under(&self, q: &Four, elevation: impl Fn([f64; 2]) -> f64) -> Four {
        let (depths, places) = (self.depths(q), four(self.params.column_place));
        core::array::from_fn(|i| depths[i] + elevation(places[i]))
    }
}

/// Of each column, from that ahead on the left.
fn four([x, y]: [f64; 2]) -> [[f64; 2]; 4] {
    [[x, y], [x, -y], [-x, y], [-x, -y]]
}

//! The coefficients of DOP853.
//!
//! Source: the code DOP853 of E. Hairer and G. Wanner, version of 2009, which belongs to E. Hairer, S. P. Nørsett and
//! G. Wanner, *Solving Ordinary Differential Equations I*, 2nd ed. 1993, sections II.5 and II.6; the digits are those
//! of SciPy 1.17 (`scipy/integrate/_ivp/dop853_coefficients.py`). Stages are counted from 0 here, from 1 there; stage
//! 12 is the end of the step, stages 13 to 15 serve the dense output alone (14 to 16 in the code).
//!
//! The tests below check all 200 order conditions of order 8, those of both error estimates, and those of the dense
//! output.

#![allow(clippy::excessive_precision)] // all digits that were published

use crate::integrator::adaptive::Weight;

/// The nodes `c` of the stages.
pub(in crate::integrator) const NODES: [f64; 16] = [
    0.0,
    0.0526001519587677318785587544488,
    0.0789002279381515978178381316732,
    0.11835034190722739672675719751,
    0.28164965809277260327324280249,
    0.333333333333333333333333333333,
    0.25,
    0.307692307692307692307692307692,
    0.651282051282051282051282051282,
    0.6,
    0.857142857142857142857142857142,
    1.0,
    1.0,
    0.1,
    0.2,
    0.777777777777777777777777777778,
];

/// Row 1 of `a`.
pub(super) const A1: [Weight; 1] = [(0, 0.0526001519587677318785587544488)];

/// Row 2 of `a`.
pub(super) const A2: [Weight; 2] = [(0, 0.0197250569845378994544595329183), (1, 0.0591751709536136983633785987549)];

/// Row 3 of `a`.
pub(super) const A3: [Weight; 2] = [(0, 0.0295875854768068491816892993775), (2, 0.0887627564304205475450678981324)];

/// Row 4 of `a`.
pub(super) const A4: [Weight; 3] = [
    (0, 0.241365134159266685502369798665),
    (2, -0.884549479328286085344864962717),
    (3, 0.924834003261792003115737966543),
];

/// Row 5 of `a`.
pub(super) const A5: [Weight; 3] = [
    (0, 0.037037037037037037037037037037),
    (3, 0.170828608729473871279604482173),
    (4, 0.125467687566822425016691814123),
];

/// Row 6 of `a`.
pub(super) const A6: [Weight; 4] = [
    (0, 0.037109375),
    (3, 0.170252211019544039314978060272),
    (4, 0.0602165389804559606850219397283),
    (5, -0.017578125),
];

/// Row 7 of `a`.
pub(super) const A7: [Weight; 5] = [
    (0, 0.0370920001185047927108779319836),
    (3, 0.170383925712239993810214054705),
    (4, 0.107262030446373284651809199168),
    (5, -0.0153194377486244017527936158236),
    (6, 0.00827378916381402288758473766002),
];

/// Row 8 of `a`.
pub(super) const A8: [Weight; 6] = [
    (0, 0.624110958716075717114429577812),
    (3, -3.36089262944694129406857109825),
    (4, -0.868219346841726006818189891453),
    (5, 27.5920996994467083049415600797),
    (6, 20.1540675504778934086186788979),
    (7, -43.4898841810699588477366255144),
];

/// Row 9 of `a`.
pub(super) const A9: [Weight; 7] = [
    (0, 0.477662536438264365890433908527),
    (3, -2.48811461997166764192642586468),
    (4, -0.590290826836842996371446475743),
    (5, 21.2300514481811942347288949897),
    (6, 15.2792336328824235832596922938),
    (7, -33.2882109689848629194453265587),
    (8, -0.0203312017085086261358222928593),
];

/// Row 10 of `a`.
pub(super) const A10: [Weight; 8] = [
    (0, -0.93714243008598732571704021658),
    (3, 5.18637242884406370830023853209),
    (4, 1.09143734899672957818500254654),
    (5, -8.14978701074692612513997267357),
    (6, -18.5200656599969598641566180701),
    (7, 22.7394870993505042818970056734),
    (8, 2.49360555267965238987089396762),
    (9, -3.0467644718982195003823669022),
];

/// Row 11 of `a`.
pub(super) const A11: [Weight; 9] = [
    (0, 2.27331014751653820792359768449),
    (3, -10.5344954667372501984066689879),
    (4, -2.00087205822486249909675718444),
    (5, -17.9589318631187989172765950534),
    (6, 27.9488845294199600508499808837),
    (7, -2.85899827713502369474065508674),
    (8, -8.87285693353062954433549289258),
    (9, 12.3605671757943030647266201528),
    (10, 0.643392746015763530355970484046),
];

/// The weights `b` of order 8: row 12 of `a`, since stage 12 is the end of the step.
pub(super) const B: [Weight; 8] = [
    (0, 0.0542937341165687622380535766363),
    (5, 4.45031289275240888144113950566),
    (6, 1.89151789931450038304281599044),
    (7, -5.8012039600105847814672114227),
    (8, 0.31116436695781989440891606237),
    (9, -0.152160949662516078556178806805),
    (10, 0.201365400804030348374776537501),
    (11, 0.0447106157277725905176885569043),
];

/// Row 13 of `a`, for the dense output alone.
pub(super) const A13: [Weight; 8] = [
    (0, 0.0561675022830479523392909219681),
    (6, 0.253500210216624811088794765333),
    (7, -0.246239037470802489917441475441),
    (8, -0.124191423263816360469010140626),
    (9, 0.15329179827876569731206322685),
    (10, 0.00820105229563468988491666602057),
    (11, 0.00756789766054569976138603589584),
    (12, -0.008298),
];

/// Row 14 of `a`, for the dense output alone.
pub(super) const A14: [Weight; 8] = [
    (0, 0.0318346481635021405060768473261),
    (5, 0.0283009096723667755288322961402),
    (6, 0.0535419883074385676223797384372),
    (7, -0.0549237485713909884646569340306),
    (10, -0.000108347328697249322858509316994),
    (11, 0.000382571090835658412954920192323),
    (12, -0.000340465008687404560802977114492),
    (13, 0.141312443674632500278074618366),
];

/// Row 15 of `a`, for the dense output alone.
pub(super) const A15: [Weight; 8] = [
    (0, -0.428896301583791923408573538692),
    (5, -4.69762141536116384314449447206),
    (6, 7.68342119606259904184240953878),
    (7, 4.06898981839711007970213554331),
    (8, 0.356727187455281109270669543021),
    (12, -0.00139902416515901462129418009734),
    (13, 2.9475147891527723389556272149),
    (14, -9.15095847217987001081870187138),
];

/// The weights of the embedded formula of order 3; `b` minus these estimate an error of order 3.
pub(super) const B_HAT_3: [Weight; 3] = [
    (0, 0.244094488188976377952755905512),
    (8, 0.733846688281611857341361741547),
    (11, 0.0220588235294117647058823529412),
];

/// `b` minus the weights of the embedded formula of order 5.
pub(super) const E5: [Weight; 8] = [
    (0, 0.01312004499419488073250102996),
    (5, -1.225156446376204440720569753),
    (6, -0.4957589496572501915214079952),
    (7, 1.664377182454986536961530415),
    (8, -0.350328848749973681688648729),
    (9, 0.3341791187130174790297318841),
    (10, 0.08192320648511571246570742613),
    (11, -0.02235530786388629525884427845),
];

/// The part `r4` of the dense output.
pub(super) const D4: [Weight; 12] = [
    (0, -8.4289382761090128651353491142),
    (5, 0.5667149535193777696253178359),
    (6, -3.0689499459498916912797304727),
    (7, 2.384667656512069828772814968),
    (8, 2.1170345824450282767155149946),
    (9, -0.8713915837779729920678990749),
    (10, 2.240437430260788275854177165),
    (11, 0.6315787787694688181557024929),
    (12, -0.0889903364513333108206981174),
    (13, 18.148505520854727256656404962),
    (14, -9.1946323924783554000451984436),
    (15, -4.4360363875948939664310572),
];

/// The part `r5` of the dense output.
pub(super) const D5: [Weight; 12] = [
    (0, 10.427508642579134603413151009),
    (5, 242.28349177525818288430175319),
    (6, 165.20045171727028198505394887),
    (7, -374.54675472269020279518312152),
    (8, -22.113666853125306036270938578),
    (9, 7.7334326684722638389603898808),
    (10, -30.674084731089398182061213626),
    (11, -9.3321305264302278729567221706),
    (12, 15.697238121770843886131091075),
    (13, -31.139403219565177677282850411),
    (14, -9.3529243588444783865713862664),
    (15, 35.81684148639408375246589854),
];

/// The part `r6` of the dense output.
pub(super) const D6: [Weight; 12] = [
    (0, 19.985053242002433820987653617),
    (5, -387.03730874935176555105901742),
    (6, -189.17813819516756882830838328),
    (7, 527.80815920542364900561016686),
    (8, -11.573902539959630126141871134),
    (9, 6.8812326946963000169666922661),
    (10, -1.000605096691083840318386098),
    (11, 0.7777137798053443209286926574),
    (12, -2.7782057523535084065932004339),
    (13, -60.196695231264120758267380846),
    (14, 84.320405506677161018159903784),
    (15, 11.99229113618278932803513003),
];

/// The part `r7` of the dense output.
pub(super) const D7: [Weight; 12] = [
    (0, -25.693933462703749003312586129),
    (5, -154.18974869023643374053993627),
    (6, -231.52937917604549567536039109),
    (7, 357.6391179106141237828534991),
    (8, 93.405324183624310003907691704),
    (9, -37.458323136451633156875139351),
    (10, 104.09964950896230045147246184),
    (11, 29.840293426660503123344363579),
    (12, -43.533456590011143754432175058),
    (13, 96.3245539591882829483949506),
    (14, -39.177261675615439165231486172),
    (15, -149.72683625798562581422125276),
];

/// `b` minus the weights of the embedded formula of order 3.
pub(super) const E3: [Weight; 8] = minus(B, B_HAT_3);

/// `row` minus `other`, whose stages are all in `row`.
const fn minus<const S: usize, const O: usize>(mut row: [Weight; S], other: [Weight; O]) -> [Weight; S] {
    let mut i = 0;
    while i < S {
        let mut j = 0;
        while j < O {
            if row[i].0 == other[j].0 {
                row[i].1 -= other[j].1;
            }
            j += 1;
        }
        i += 1;
    }
    row
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;
    use std::vec;
    use std::vec::Vec;

    fn rows() -> [&'static [Weight]; 16] {
        [&[], &A1, &A2, &A3, &A4, &A5, &A6, &A7, &A8, &A9, &A10, &A11, &B, &A13, &A14, &A15]
    }

    /// A rooted tree: its subtrees, in descending order of their number in the list of all trees.
    struct Tree {
        order: usize,
        subtrees: Vec<usize>,
    }

    /// All rooted trees of at most `order` nodes, by order.
    fn trees(order: usize) -> Vec<Tree> {
        fn extend(trees: &[Tree], nodes: usize, largest: usize, chosen: &mut Vec<usize>, found: &mut Vec<Vec<usize>>) {
            if nodes == 0 {
                found.push(chosen.clone());
            }
            for i in 0..largest {
                if trees[i].order <= nodes {
                    chosen.push(i);
                    extend(trees, nodes - trees[i].order, i + 1, chosen, found);
                    chosen.pop();
                }
            }
        }
        let mut trees: Vec<Tree> = vec![];
        for order in 1..=order {
            let mut found = vec![];
            extend(&trees, order - 1, trees.len(), &mut vec![], &mut found);
            trees.extend(found.into_iter().map(|subtrees| Tree { order, subtrees }));
        }
        trees
    }

    /// For every tree its order, its density `γ`, and the products `Φᵢ` of the stages (Hairer, section II.2).
    fn conditions(order: usize) -> Vec<(usize, f64, [f64; 16])> {
        let mut known: Vec<(usize, f64, [f64; 16])> = vec![];
        for tree in trees(order) {
            let mut density = tree.order as f64;
            let mut phi = [1.0; 16];
            for &subtree in &tree.subtrees {
                let (_, subdensity, subphi) = known[subtree];
                density *= subdensity;
                for i in 0..16 {
                    phi[i] *= rows()[i].iter().map(|&(j, a)| a * subphi[j]).sum::<f64>();
                }
            }
            known.push((tree.order, density, phi));
        }
        known
    }

    fn sum(weights: &[Weight], phi: &[f64; 16]) -> f64 {
        weights.iter().map(|&(i, w)| w * phi[i]).sum()
    }

    /// Rounding: weights up to 60 times products up to 60 at most.
    const TOLERANCE: f64 = 1e-13;

    #[test]
    fn there_are_as_many_trees_as_in_the_book() {
        let trees = trees(8);
        let count: Vec<usize> = (1..=8).map(|order| trees.iter().filter(|tree| tree.order == order).count()).collect();
        assert_eq!(count, [1, 1, 2, 4, 9, 20, 48, 115]);
    }

    #[test]
    fn nodes_are_row_sums() {
        for i in 0..16 {
            let row: f64 = rows()[i].iter().map(|&(_, a)| a).sum();
            assert!((row - NODES[i]).abs() < 3e-14, "stage {i}: {}", row - NODES[i]);
        }
    }

    #[test]
    fn the_formula_has_order_eight_and_not_nine() {
        let mut worst_of_nine: f64 = 0.0;
        for (order, density, phi) in conditions(9) {
            let error = sum(&B, &phi) - 1.0 / density;
            if order <= 8 {
                assert!(error.abs() < TOLERANCE, "order {order}: {error}");
            } else {
                worst_of_nine = worst_of_nine.max(error.abs());
            }
        }
        assert!(worst_of_nine > 1e-7);
    }

    #[test]
    fn the_error_estimates_vanish_up_to_their_orders() {
        for (weights, estimate) in [(&E5, 5), (&E3, 3)] {
            let mut beyond: f64 = 0.0;
            for (order, _, phi) in conditions(estimate + 1) {
                let error = sum(weights, &phi);
                if order <= estimate {
                    assert!(error.abs() < TOLERANCE, "estimate {estimate}, order {order}: {error}");
                } else {
                    beyond = beyond.max(error.abs());
                }
            }
            assert!(beyond > 1e-4, "estimate {estimate}: {beyond}");
        }
    }

    #[test]
    fn the_dense_output_has_order_seven() {
        // The weights b(θ) of y(θ) = y₀ + h Σ b(θ) k, from r₁ = h Σ b k, r₂ = h k₀ − r₁, r₃ = 2 r₁ − h (k₀ + k₁₂).
        let weights = |theta: f64| {
            let dense = |row: &[Weight]| {
                let mut w = [0.0; 16];
                row.iter().for_each(|&(i, value)| w[i] += value);
                w
            };
            let r1 = dense(&B);
            let (first, last) = (dense(&[(0, 1.0)]), dense(&[(12, 1.0)]));
            let r2: [f64; 16] = core::array::from_fn(|i| first[i] - r1[i]);
            let r3: [f64; 16] = core::array::from_fn(|i| 2.0 * r1[i] - first[i] - last[i]);
            let parts = [r1, r2, r3, dense(&D4), dense(&D5), dense(&D6), dense(&D7)];
            let mut w = [0.0; 16];
            for (power, part) in parts.iter().enumerate().rev() {
                for i in 0..16 {
                    w[i] = (w[i] + part[i]) * if power % 2 == 0 { theta } else { 1.0 - theta };
                }
            }
            w
        };
        let mut worst_of_eight: f64 = 0.0;
        for theta in [0.1, 0.25, 0.5, 0.8, 0.95] {
            let w = weights(theta);
            for (order, density, phi) in conditions(8) {
                let sum: f64 = (0..16).map(|i| w[i] * phi[i]).sum();
                let error = sum - theta.powi(order as i32) / density;
                if order <= 7 {
                    assert!(error.abs() < 10.0 * TOLERANCE, "θ = {theta}, order {order}: {error}");
                } else {
                    worst_of_eight = worst_of_eight.max(error.abs());
                }
            }
        }
        assert!(worst_of_eight > 1e-7);
    }
}

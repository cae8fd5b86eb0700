//! The gradient of a sample.

use super::counted::{Counted, Neighbourhood, counted, show};
use cube3_frame::{DiscreteRay, FrameSetup, GradientRegisters, GradientScale, RayRegisters};
use cube3_machine::{Differences, GradientMethod};
use cube3_word::{Probe, Words, lerp_wires, saturate};

/// What the gradient of a sample is weighted with: in a parallel frame the same for all, in perspective of its own ray and depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Local {
    /// Whether the ray runs against u and against v: the neighbourhood is then taken in the mirror.
    pub mirrored: [bool; 2],
    /// How far the ray moves along u and v to the next plane, in rays, fractions of the weight bits: at the sample's own slice.
    pub here: [u32; 2],
    /// The same in rays of slice k + 1.
    pub behind: [u32; 2],
    /// And of slice k − 1.
    pub before: [u32; 2],
    /// Factors of the components.
    pub factors: Option<[u32; 3]>,
    /// Factor of the difference along the ray, a fraction of [`GradientScale::FACTOR_BITS`].
    pub nearness: Option<u32>,
}

impl Local {
    /// Every sample of a parallel frame.
    pub fn parallel(registers: &GradientRegisters) -> Local {
        let weights = registers.weights;
        let factors = registers.scale.map(|scale| scale.factors);
        Local { mirrored: [false; 2], here: weights, behind: weights, before: weights, factors, nearness: None }
    }

    /// Sample k of ray (u, v), `at`, of a frame.
    pub fn new(at: [i64; 3], registers: &GradientRegisters, setup: &FrameSetup) -> Local {
        let (Some(pass), Some(rays)) = (&setup.geometry.perspective, &setup.rays) else {
            return Local::parallel(registers);
        };
        let [i, j, k] = [(at[0] - pass.u.first) as usize, (at[1] - pass.v.first) as usize, at[2] as usize];
        let last = rays.closeness.len() - 1;
        let shear = |k: usize| {
            [rays.slope_u[i], rays.slope_v[j]]
                .map(|slope| RayRegisters::shear(slope, rays.closeness[k], setup.words.weight_bits))
        };
        Local {
            mirrored: setup.geometry.mirrored(DiscreteRay { u: at[0], v: at[1] }),
            here: shear(k),
            behind: shear((k + 1).min(last)),
            before: shear(k.saturating_sub(1)),
            factors: Some(rays.factors[k]),
            nearness: rays.nearness.as_ref().map(|nearness| nearness[k]),
        }
    }
}

/// The gradient of a sample of a parallel frame, three signed words of `gradient_bits` and what the scale keeps below them.
///
/// Each component stands for the difference of two samples that are two voxels (or two steps) apart, without
/// the low bits that the word has no room for.
pub fn gradient(s: &Neighbourhood, registers: &GradientRegisters, words: &Words) -> Counted<[i32; 3]> {
    local_gradient(s, registers, &Local::parallel(registers), words)
}

/// The gradient of a sample of any frame.
pub fn local_gradient(
    s: &Neighbourhood,
    registers: &GradientRegisters,
    local: &Local,
    words: &Words,
) -> Counted<[i32; 3]> {
    counted(local_gradient_wires(s, registers, local, words, &mut ()))
}

/// [`local_gradient`], whether each word was saturated, and what its wires carry: components u and v are the part `across`,
/// w is `along`.
pub fn local_gradient_wires(
    s: &Neighbourhood,
    registers: &GradientRegisters,
    local: &Local,
    words: &Words,
    probe: &mut impl Probe,
) -> [(i32, bool); 3] {
    let turn = |i: usize, mirrored: bool| if mirrored { 2 - i } else { i };
    let [mirror_u, mirror_v] = local.mirrored;
    let s = [0, 1, 2].map(|w| [0, 1, 2].map(|v| [0, 1, 2].map(|u| s[w][turn(v, mirror_v)][turn(u, mirror_u)])));
    let (differences, extra) = differences(&s, registers.method, local, words, probe);
    let kept = registers.scale.map_or(0, |scale| scale.kept_bits);
    [0, 1, 2].map(|i| {
        let (part, place) = [("across", 0), ("across", 1), ("along", 0)][i];
        probe.within(part, place, |probe| {
            let mirrored = local.mirrored.get(i) == Some(&true);
            let turned = if mirrored { -differences[i] } else { differences[i] };
            let scaled = match local.factors {
                Some(factors) => {
                    let product = turned * i64::from(factors[i]);
                    probe.wire("product", 0, product.into());
                    words.rounding.shift_right(product, GradientScale::FACTOR_BITS - kept)
                }
                None => turned,
            };
            let dropped = words.rounding.shift_right(scaled, words.gradient_drop() + extra);
            let (word, saturated) = saturate(dropped, words.gradient_bits + kept);
            probe.wire("difference", 0, differences[i].into());
            if i < 2 {
                probe.wire("turned", 0, turned.into());
            }
            probe.wire("scaled", 0, scaled.into());
            probe.wire("dropped", 0, dropped.into());
            probe.wire("word", 0, word.into());
            (word, saturated)
        })
    })
}

/// Differences along u, v and w, and the bits by which their weights exceed 1.
fn differences(
    s: &Neighbourhood,
    method: GradientMethod,
    local: &Local,
    words: &Words,
    probe: &mut impl Probe,
) -> ([i64; 3], u32) {
    let [du, dv] = local.here;
    let between = |far: i32, near: i32| i64::from(far) - i64::from(near);
    let straight =
        || [between(s[1][1][2], s[1][1][0]), between(s[1][2][1], s[1][0][1]), between(s[2][1][1], s[0][1][1])];
    let row = method.row();
    let differences = match row.differences {
        Differences::Central => straight(),
        Differences::Weighted => weighted(s, probe),
        Differences::Feet => {
            let mut foot = |place, side: i32, on_ray: i32, weight| {
                probe.within("foot", place, |probe| {
                    lerp_wires(side, on_ray, weight, words.weight_bits, words.rounding, probe)
                })
            };
            // The foot of the perpendicular from a side ray lies towards the eye on the right, away on the left.
            let right = foot(0, s[1][1][2], s[0][1][2], du);
            let left = foot(1, s[1][1][0], s[2][1][0], du);
            let below = foot(2, s[1][2][1], s[0][2][1], dv);
            let above = foot(3, s[1][0][1], s[2][0][1], dv);
            let [_, _, ray] = straight();
            [between(right, left), between(below, above), ray]
        }
        Differences::Bilinear => {
            // Straight behind the sample on slice k+1 lies between rays u−1 and u, v−1 and v; before it, the mirror image.
            let mut bilinear = |number: usize, slice: &[[i32; 3]; 3], v: usize, u: usize, [du, dv]: [u32; 2]| {
                let mut lerp = |part, place, near, far, weight| {
                    probe.within(part, place, |probe| {
                        lerp_wires(near, far, weight, words.weight_bits, words.rounding, probe)
                    })
                };
                let near = lerp("along_u", 2 * number, slice[1][1], slice[1][u], du);
                let far = lerp("along_u", 2 * number + 1, slice[v][1], slice[v][u], du);
                lerp("along_v", number, near, far, dv)
            };
            let behind = bilinear(0, &s[2], 0, 0, local.behind);
            let before = bilinear(1, &s[0], 2, 2, local.before);
            let [u, v, _] = straight();
            [u, v, between(behind, before)]
        }
    };
    let differences = near(differences, local, words, probe);
    let differences = if row.sheared { shear(differences, local, words, probe) } else { differences };
    (differences, row.extra_bits())
}

/// Where neighbours are less than a voxel away, u and v are relative to their distance, and so is the ray.
fn near([u, v, ray]: [i64; 3], local: &Local, words: &Words, probe: &mut impl Probe) -> [i64; 3] {
    let Some(nearness) = local.nearness else {
        return [u, v, ray];
    };
    let product = ray * i64::from(nearness);
    let near = words.rounding.shift_right(product, GradientScale::FACTOR_BITS);
    probe.within("along", 0, |probe| {
        probe.wire("straight", 0, ray.into());
        probe.wire("near_product", 0, product.into());
        probe.wire("near", 0, near.into());
    });
    [u, v, near]
}

/// What the ray's difference has of u and v is taken away.
fn shear([u, v, ray]: [i64; 3], local: &Local, words: &Words, probe: &mut impl Probe) -> [i64; 3] {
    let [du, dv] = local.here;
    let products = [u * i64::from(du), v * i64::from(dv)];
    let sum = products[0] + products[1];
    let shear = words.rounding.shift_right(sum, words.weight_bits);
    probe.within("along", 0, |probe| {
        show(probe, "shear_product", products);
        probe.wire("shear_sum", 0, sum.into());
        probe.wire("shear", 0, shear.into());
    });
    [u, v, ray - shear]
}

/// Differences of the 26-neighbourhood with weights 4, 2, 1 by Manhattan distance: sixteen times those of one pair.
fn weighted(s: &Neighbourhood, probe: &mut impl Probe) -> [i64; 3] {
    let mut sums = [0; 3];
    for (a, first) in [1, 2, 1].into_iter().enumerate() {
        for (b, second) in [1, 2, 1].into_iter().enumerate() {
            let pairs = [[s[a][b][2], s[a][b][0]], [s[a][2][b], s[a][0][b]], [s[2][a][b], s[0][a][b]]];
            for (axis, [far, near]) in pairs.into_iter().enumerate() {
                let pair = i64::from(far) - i64::from(near);
                probe.wire("pair", 9 * axis + 3 * a + b, pair.into());
                sums[axis] += first * second * pair;
            }
        }
    }
    sums
}

//! Gauss and Legendre's rules, the integrals of what interpolates at their nodes, and how far both can be off.

use std::sync::LazyLock;

/// The numbers of nodes that there are rules for.
const COUNTS: [usize; 10] = [1, 2, 3, 4, 5, 6, 8, 10, 12, 16];

/// Every rule, in the order of its nodes.
pub(crate) static RULES: LazyLock<Vec<Rule>> = LazyLock::new(|| COUNTS.map(Rule::new).into());

/// The rule of n nodes on [−1, 1].
#[derive(Clone, Debug)]
pub(crate) struct Rule {
    /// Ascending.
    pub nodes: Vec<f64>,
    /// They add up to 2.
    pub weights: Vec<f64>,
    /// Row j, column l: the integral from −1 to node j of the polynomial that is 1 at node l and 0 at the others.
    pub integrals: Vec<Vec<f64>>,
    /// The largest sum of magnitudes in a row of the integrals.
    largest_row: f64,
}

impl Rule {
    fn new(count: usize) -> Rule {
        let nodes: Vec<f64> = (0..count).rev().map(|i| node(count, i)).collect();
        let weight = |&x: &f64| {
            let slope = count as f64 * (legendre(count - 1, x) - x * legendre(count, x)) / (1.0 - x * x);
            2.0 / ((1.0 - x * x) * slope * slope)
        };
        let weights: Vec<f64> = nodes.iter().map(weight).collect();
        // The polynomial of node l is w_l·Σ (k + ½)·P_k(x_l)·P_k, and (2k + 1)·∫P_k is P_{k+1} − P_{k−1}.
        let integral = |x: f64, l: usize| {
            let higher = (1..count).map(|k| legendre(k, nodes[l]) * (legendre(k + 1, x) - legendre(k - 1, x)));
            weights[l] * 0.5 * ((x + 1.0) + higher.sum::<f64>())
        };
        let integrals: Vec<Vec<f64>> = nodes.iter().map(|&x| (0..count).map(|l| integral(x, l)).collect()).collect();
        let sum = |row: &Vec<f64>| row.iter().map(|x| x.abs()).sum::<f64>();
        let largest_row = integrals.iter().map(sum).fold(0.0, f64::max);
        Rule { nodes, weights, integrals, largest_row }
    }

    pub fn count(&self) -> usize {
        self.nodes.len()
    }

    /// The most that the rule is off by for a function that is analytic in Bernstein's ellipse of parameter `rho` and there at most 1 away
    /// from a constant: with f = Σ a_k·T_k and |a_k| ≤ 2ρ^−k, the rule is exact to degree 2n − 1, odd terms cancel, and an even one costs at
    /// most 2 + 2/(k² − 1). So (64/15)·ρ^−2n/(1 − ρ^−2), and for a single node 16/3 instead of 64/15. Trefethen, Approximation Theory and
    /// Approximation Practice, theorem 19.3.
    #[inline]
    pub fn error(&self, rho: f64) -> f64 {
        let n = self.count();
        let constant = if n == 1 { 16.0 / 3.0 } else { 64.0 / 15.0 };
        let inverse = 1.0 / rho;
        constant * inverse.powi(2 * n as i32) / (1.0 - inverse * inverse)
    }

    /// The most that the integrals from −1 to the nodes are off by for such a function: T_k's own is at most 2, and that of what interpolates
    /// it at most a row's sum; Σ over k ≥ n of 2ρ^−k·(2 + row).
    #[inline]
    pub fn error_of_integrals(&self, rho: f64) -> f64 {
        let inverse = 1.0 / rho;
        2.0 * (2.0 + self.largest_row) * inverse.powi(self.count() as i32) / (1.0 - inverse)
    }
}

/// Legendre's polynomial P_k.
fn legendre(k: usize, x: f64) -> f64 {
    let (mut before, mut here) = (1.0, x);
    if k == 0 {
        return 1.0;
    }
    for j in 2..=k {
        let j = j as f64;
        (before, here) = (here, ((2.0 * j - 1.0) * x * here - (j - 1.0) * before) / j);
    }
    here
}

/// The i-th root of P_n from above, by Newton's method from Tricomi's guess; the middle one is 0 exactly.
fn node(n: usize, i: usize) -> f64 {
    if 2 * i + 1 == n {
        return 0.0;
    }
    let mut x = libm::cos(std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5));
    for _ in 0..8 {
        let slope = n as f64 * (legendre(n - 1, x) - x * legendre(n, x)) / (1.0 - x * x);
        x -= legendre(n, x) / slope;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rule_is_exact_to_twice_its_nodes() {
        for rule in RULES.iter() {
            for degree in 0..2 * rule.count() {
                let sum: f64 = rule.nodes.iter().zip(&rule.weights).map(|(x, w)| w * x.powi(degree as i32)).sum();
                let exact = if degree % 2 == 0 { 2.0 / (degree + 1) as f64 } else { 0.0 };
                assert!((sum - exact).abs() < 1e-14, "{} nodes, degree {degree}: {sum}", rule.count());
            }
        }
    }

    #[test]
    fn integrals_to_the_nodes_are_exact_below_their_number() {
        for rule in RULES.iter() {
            for degree in 0..rule.count() as i32 {
                let antiderivative =
                    |x: f64| (x.powi(degree + 1) - (-1.0_f64).powi(degree + 1)) / f64::from(degree + 1);
                for (row, &x) in rule.integrals.iter().zip(&rule.nodes) {
                    let sum: f64 = row.iter().zip(&rule.nodes).map(|(a, node)| a * node.powi(degree)).sum();
                    assert!((sum - antiderivative(x)).abs() < 1e-14);
                }
            }
        }
    }

    /// 1/(x − p) has its pole where an ellipse of ρ = p + √(p² − 1) ends, and no error that the bounds do not have.
    #[test]
    fn a_pole_outside_of_the_ellipse_keeps_the_bounds() {
        for rho in [1.3, 2.0, 4.0, 9.0] {
            let pole = (rho + 1.0 / rho) / 2.0 * 1.02;
            let largest = 1.0 / (pole - (rho + 1.0 / rho) / 2.0);
            let f = |x: f64| 1.0 / (pole - x);
            let mut tightest = 0.0_f64;
            for rule in RULES.iter() {
                let values: Vec<f64> = rule.nodes.iter().map(|&x| f(x)).collect();
                let sum: f64 = values.iter().zip(&rule.weights).map(|(f, w)| w * f).sum();
                let exact = ((pole + 1.0) / (pole - 1.0)).ln();
                let error = (sum - exact).abs();
                assert!(error <= largest * rule.error(rho) + 1e-14, "{} nodes, {rho}", rule.count());
                tightest = tightest.max(error / (largest * rule.error(rho)));
                for (row, &x) in rule.integrals.iter().zip(&rule.nodes) {
                    let sum: f64 = row.iter().zip(&values).map(|(a, f)| a * f).sum();
                    let exact = ((pole + 1.0) / (pole - x)).ln();
                    assert!((sum - exact).abs() <= largest * rule.error_of_integrals(rho) + 1e-14);
                }
            }
            assert!(tightest > 1e-3, "{tightest}");
        }
    }
}

//! The rotation nearest to a linear map. It knows nothing of cells or forces.

use crate::math::{Real, Vector};

/// Newton's method takes four steps for a cell that is whole, more towards a double root.
const NEWTON_STEPS: usize = 8;

/// Where the rotation is not unique, `ζ` below vanishes; below this share of λ³ the result fades out.
const MIN_ZETA_SHARE: f64 = 0.01;

/// Returns the columns of the rotation R with the greatest `tr(Rᵀ F)`, given the columns of F and of its cofactors
/// (`faces = [b×c, c×a, a×b]`). It is a rotation even for a mirrored F, and zero or shorter where no rotation is the
/// nearest.
///
/// Markley's form (1993, FOAM): with the greatest root λ of `(λ² − |F|²)² − 8 λ det F − 4 |cof F|²` and `κ = (λ² − |F|²)/2`
/// it is `R = ((κ + |F|²) F + λ cof F − F Fᵀ F)/ζ`, `ζ = κ λ − det F`. `R Fᵀ` is symmetric for any λ and ζ: a pull of F
/// towards R makes no torque, not even by an error of λ.
///
/// The second result is λ, which is `tr(Rᵀ F)`.
#[inline]
pub(in crate::physics) fn nearest_rotation<R: Real>(columns: &[R::Vec3; 3], faces: &[R::Vec3; 3]) -> ([R::Vec3; 3], R) {
    let square = |of: &[R::Vec3; 3]| of.iter().fold(R::ZERO, |sum, column| sum + column.dot(*column));
    let (size, cofactors, det) = (square(columns), square(faces), columns[0].dot(faces[0]));
    let [two, four, eight] = [2.0, 4.0, 8.0].map(R::from_f64);
    let mut root = (R::from_f64(3.0) * size).sqrt();
    for _ in 0..NEWTON_STEPS {
        let over = root * root - size;
        let slope = four * root * over - eight * det;
        if slope <= R::ZERO {
            break;
        }
        root -= (over * over - eight * root * det - four * cofactors) / slope;
    }
    let kappa = (root * root - size) / two;
    let zeta = (kappa * root - det).max(R::from_f64(MIN_ZETA_SHARE) * root * root * root);
    if !zeta.is_finite() || zeta <= R::ZERO {
        return ([R::Vec3::ZERO; 3], R::ZERO);
    }
    let inverse = R::ONE / zeta;
    let rotation = std::array::from_fn(|j| {
        let stretched = (0..3).fold(R::Vec3::ZERO, |sum, i| sum + columns[i] * columns[i].dot(columns[j]));
        (columns[j] * (kappa + size) + faces[j] * root - stretched) * inverse
    });
    (rotation, root)
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};

    use super::*;
    use crate::math::rng::Rng;

    fn nearest(map: DMat3) -> DMat3 {
        let [a, b, c] = [map.x_axis, map.y_axis, map.z_axis];
        let ([x, y, z], _) = nearest_rotation::<f64>(&[a, b, c], &[b.cross(c), c.cross(a), a.cross(b)]);
        DMat3::from_cols(x, y, z)
    }

    fn turned() -> DMat3 {
        DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 2.0)
    }

    #[test]
    fn what_is_turned_and_stretched_or_mirrored_has_its_rotation() {
        for stretch in [DVec3::ONE, DVec3::new(2.0, 1.0, 0.3), DVec3::new(1.0, 2.0, 0.0), DVec3::new(1.0, 0.9, -0.4)] {
            let found = nearest(turned() * DMat3::from_diagonal(stretch));
            assert!(found.abs_diff_eq(turned(), 1e-6), "{stretch}: {found}");
        }
    }

    #[test]
    fn nothing_that_is_pulled_to_it_is_turned() {
        let mut rng = Rng::new(5);
        for _ in 0..1000 {
            let map = DMat3::from_cols_array(&[0; 9].map(|_| rng.between(-2.0, 2.0)));
            let product = nearest(map) * map.transpose();
            assert!(product.abs_diff_eq(product.transpose(), 1e-10), "{map} gives a torque: {product}");
        }
    }

    #[test]
    fn where_no_rotation_is_the_nearest_the_result_is_short() {
        for map in [DMat3::ZERO, DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0)), DMat3::from_diagonal(DVec3::X)] {
            let found = nearest(map);
            assert!(found.is_finite() && found.determinant() < 0.5, "{map}: {found}");
        }
    }
}

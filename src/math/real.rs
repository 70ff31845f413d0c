//! The scalar and vector the physics is written over: `f32` with [`glam::Vec3`] to run, `f64` with
//! [`glam::DVec3`] as reference. Only IEEE-exact operations are offered (no fused multiply-add, no
//! transcendental functions), so that one source gives the same bits on every machine.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use bytemuck::Pod;
use glam::{DVec3, Vec3};

/// A floating-point scalar: `f32` or `f64`.
pub trait Real:
    Copy
    + Debug
    + Default
    + PartialEq
    + PartialOrd
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + Pod
{
    /// The three-component vector of this scalar.
    type Vec3: Vector<Self>;

    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// The distance from 1 to the next larger number.
    const EPSILON: Self;

    /// Rounds a double to this precision.
    fn from_f64(value: f64) -> Self;
    /// Widens to a double, exactly.
    fn to_f64(self) -> f64;
    /// The IEEE square root.
    fn sqrt(self) -> Self;
    /// The magnitude.
    fn abs(self) -> Self;
    /// The smaller of two numbers.
    fn min(self, other: Self) -> Self;
    /// The larger of two numbers.
    fn max(self, other: Self) -> Self;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// The bit pattern, for hashes and exact files.
    fn bits(self) -> u64;
    /// The inverse of [`Real::bits`].
    fn from_bits(bits: u64) -> Self;
}

/// A three-component vector over a [`Real`].
pub trait Vector<R>:
    Copy
    + Debug
    + Default
    + PartialEq
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Neg<Output = Self>
    + Mul<R, Output = Self>
    + AddAssign
    + SubAssign
    + Pod
{
    /// The null vector.
    const ZERO: Self;

    /// From components.
    fn new(x: R, y: R, z: R) -> Self;
    /// The components.
    fn components(self) -> [R; 3];
    /// The inner product.
    fn dot(self, other: Self) -> R;
    /// The cross product.
    fn cross(self, other: Self) -> Self;
    /// The Euclidean length.
    fn length(self) -> R;
    /// The smaller of each component.
    fn min(self, other: Self) -> Self;
    /// The larger of each component.
    fn max(self, other: Self) -> Self;
    /// All components finite.
    fn is_finite(self) -> bool;
    /// Rounds a double vector to this precision.
    fn from_dvec3(v: DVec3) -> Self;
    /// Widens to a double vector, exactly.
    fn to_dvec3(self) -> DVec3;
}

/// The components of vectors, one after another: `x y z x y z …`.
#[inline]
pub fn components<R: Real>(of: &[R::Vec3]) -> &[R] {
    bytemuck::cast_slice(of)
}

/// The components of vectors, to write.
#[inline]
pub fn components_mut<R: Real>(of: &mut [R::Vec3]) -> &mut [R] {
    bytemuck::cast_slice_mut(of)
}

macro_rules! real {
    ($scalar:ty, $vector:ty, $round:path, $narrow:path) => {
        impl Real for $scalar {
            type Vec3 = $vector;

            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const EPSILON: Self = <$scalar>::EPSILON;

            #[inline]
            fn from_f64(value: f64) -> Self {
                $round(value)
            }
            #[inline]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline]
            fn sqrt(self) -> Self {
                self.sqrt()
            }
            #[inline]
            fn abs(self) -> Self {
                self.abs()
            }
            #[inline]
            fn min(self, other: Self) -> Self {
                self.min(other)
            }
            #[inline]
            fn max(self, other: Self) -> Self {
                self.max(other)
            }
            #[inline]
            fn is_finite(self) -> bool {
                self.is_finite()
            }
            #[inline]
            fn bits(self) -> u64 {
                u64::from(self.to_bits())
            }
            #[inline]
            fn from_bits(bits: u64) -> Self {
                <$scalar>::from_bits($narrow(bits))
            }
        }

        impl Vector<$scalar> for $vector {
            const ZERO: Self = <$vector>::ZERO;

            #[inline]
            fn new(x: $scalar, y: $scalar, z: $scalar) -> Self {
                <$vector>::new(x, y, z)
            }
            #[inline]
            fn components(self) -> [$scalar; 3] {
                self.to_array()
            }
            #[inline]
            fn dot(self, other: Self) -> $scalar {
                self.dot(other)
            }
            #[inline]
            fn cross(self, other: Self) -> Self {
                self.cross(other)
            }
            #[inline]
            fn length(self) -> $scalar {
                self.length()
            }
            #[inline]
            fn min(self, other: Self) -> Self {
                self.min(other)
            }
            #[inline]
            fn max(self, other: Self) -> Self {
                self.max(other)
            }
            #[inline]
            fn is_finite(self) -> bool {
                self.is_finite()
            }
            #[inline]
            fn from_dvec3(v: DVec3) -> Self {
                <$vector>::new(
                    <$scalar as Real>::from_f64(v.x),
                    <$scalar as Real>::from_f64(v.y),
                    <$scalar as Real>::from_f64(v.z),
                )
            }
            #[inline]
            fn to_dvec3(self) -> DVec3 {
                DVec3::new(f64::from(self.x), f64::from(self.y), f64::from(self.z))
            }
        }
    };
}

real!(f32, Vec3, round_to_f32, low_half);
real!(f64, DVec3, std::convert::identity, std::convert::identity);

#[expect(clippy::cast_possible_truncation, reason = "rounding is the point")]
fn round_to_f32(value: f64) -> f32 {
    value as f32
}

#[expect(clippy::cast_possible_truncation, reason = "the upper half of an f32's bits is empty")]
fn low_half(bits: u64) -> u32 {
    bits as u32
}

//! How hard an obstacle pushes back, as a number or a word.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

/// How hard an obstacle pushes back.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ContactStiffness {
    /// 1e5 s⁻² × particle mass, raised where a body at rest would sink more than 2 % of its size.
    #[default]
    Auto,
    /// Given, N/m per particle.
    Given(f64),
}

impl Serialize for ContactStiffness {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => serializer.serialize_str("auto"),
            Self::Given(stiffness) => serializer.serialize_f64(*stiffness),
        }
    }
}

impl<'de> Deserialize<'de> for ContactStiffness {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl de::Visitor<'_> for Visitor {
            type Value = ContactStiffness;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a stiffness in N/m or \"auto\"")
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<Self::Value, E> {
                match text {
                    "auto" => Ok(ContactStiffness::Auto),
                    _ => Err(E::invalid_value(de::Unexpected::Str(text), &self)),
                }
            }
            fn visit_f64<E: de::Error>(self, stiffness: f64) -> Result<Self::Value, E> {
                Ok(ContactStiffness::Given(stiffness))
            }
            fn visit_i64<E: de::Error>(self, stiffness: i64) -> Result<Self::Value, E> {
                Ok(ContactStiffness::Given(stiffness as f64))
            }
            fn visit_u64<E: de::Error>(self, stiffness: u64) -> Result<Self::Value, E> {
                Ok(ContactStiffness::Given(stiffness as f64))
            }
        }
        deserializer.deserialize_any(Visitor)
    }
}

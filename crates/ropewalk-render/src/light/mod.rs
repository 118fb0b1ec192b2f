//! The light of a picture for the tree of rays and for paths: what shines, and what surrounds the scene.
//!
//! Which lights there are, and how bright, is decided in [`crate::lights`], for all integrators alike; here they stand
//! in the form that both devices work with: f32, and no constant that a compiler could move. So light is measured by
//! the radiance of a white matt surface that faces it, which is the irradiance over pi, and no pi is left.
//!
//! **Words**, as [`crate::looks`] holds them for both devices. Floats stand as their bits.
//!
//! | word | what |
//! |---|---|
//! | 0 | the number of sources |
//! | 1 | the kind of environment: 0 studio, 1 even |
//! | 2 to 4 | up |
//! | 5 to 7 | to the main light |
//! | 8 to 10 | the radiance of an even environment |
//! | 11 to 13 | ambient light |
//! | 14 to 28 | the colours of the studio: lower, upper, horizon, zenith, lamp, three words each |
//! | 29 to 31 | the mean radiance that a matt surface sees of an even environment |
//! | 32 and on | sources, [`SOURCE_WORDS`] each: 0 its kind (0 sun, 1 point, 2 lamp), 1 to 3 its place, or the direction to a sun; 4 its radius; 5 to 7 its light |

mod environment;
mod source;

pub(crate) use environment::Environment;
pub(crate) use source::{LightSource, SOURCE_WORDS};

use crate::lights::{LightChoice, Lighting};
use crate::stage::Stage;
use ropewalk_scene::Camera;

/// Words before the first source.
pub(crate) const ENVIRONMENT_WORDS: usize = 32;

/// All light of a picture.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Lights {
    pub(crate) sources: Vec<LightSource>,
    pub(crate) environment: Environment,
    /// Lights of the file that are left out because their numbers are none.
    pub(crate) left_out: usize,
}

impl Lights {
    /// Sets the lights for a picture. With `hard`, they have no size.
    pub(crate) fn new(stage: &Stage, camera: &Camera, choice: &LightChoice, hard: bool) -> Self {
        let lighting = Lighting::new(stage, camera, choice, hard);
        Self {
            sources: lighting.sources.iter().map(LightSource::new).collect(),
            environment: Environment::new(stage, &lighting),
            left_out: lighting.left_out,
        }
    }

    /// The words, as the table above has them.
    pub(crate) fn words(&self) -> Vec<u32> {
        let mut words = Vec::with_capacity(ENVIRONMENT_WORDS + self.sources.len() * SOURCE_WORDS);
        words.push(self.sources.len() as u32);
        words.extend(self.environment.words());
        words.resize(ENVIRONMENT_WORDS, 0);
        self.sources.iter().for_each(|source| words.extend(source.words()));
        words
    }
}

//! Two normal maps to one.

mod degenerate;
mod eight_bits;
mod floats;
mod laws;
mod masks;
mod sixteen_bits;

use crate::oracle::{UnormZero, blend};
use crate::support::{assert_every_blend, blend_options, number, weighted};
use texbake::{BlendInputs, BlendMethod, HeightMap, NormalFormat, NormalMap};

/// Every method but the masked blend.
fn every_method() -> [BlendMethod; 8] {
    let transition = BlendMethod::transition(number("1/4")).expect("between 0 and 1");
    let slopes = [BlendMethod::add(), weighted("3", "-2/7"), transition];
    let [add, weighted, transition] = slopes;
    use BlendMethod::{Linear, Overlay, Rnm, Udn, Whiteout};
    [add, weighted, transition, Linear, Overlay, Udn, Whiteout, Rnm]
}

/// Every baker blends integer maps as the oracle does.
fn assert_right(inputs: &BlendInputs<&NormalMap, &HeightMap>, method: BlendMethod, format: NormalFormat) {
    let options = blend_options(method, format);
    assert_every_blend(inputs, &options, &blend(inputs, &options, UnormZero::Zero).image);
}

//! A substep in each of the two precisions, compiled once.
//!
//! A generic function is compiled again in every crate that calls it, with all generic functions that it calls: each test or
//! bench that takes a step would compile the whole core again. So substeps go through two functions that are not generic.

use std::any::{Any, TypeId};

use super::{Ending, Inputs, StepWorkspace, take_part};
use crate::math::Real;
use crate::physics::model::Model;
use crate::physics::model::plan::Plan;
use crate::physics::report::Recorder;
use crate::physics::state::State;
use crate::physics::step::substep::Part;

/// The arguments of [`take_part`].
struct Call<'a, 'r, R: Real> {
    model: &'a Model<R>,
    plan: &'a Plan,
    part: Part,
    inputs: Inputs<'a, R>,
    state: &'a mut State<R>,
    workspace: &'a mut StepWorkspace<R>,
    recorder: &'a mut Recorder<'r>,
}

/// Advances the state by a substep or a part of it.
pub(in crate::physics) fn substep<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    part: Part,
    inputs: Inputs<'_, R>,
    state: &mut State<R>,
    workspace: &mut StepWorkspace<R>,
    recorder: &mut Recorder<'_>,
) -> Ending {
    let call = Call { model, plan, part, inputs, state, workspace, recorder };
    if TypeId::of::<R>() == TypeId::of::<f32>() { take_single(call.cast()) } else { take_double(call.cast()) }
}

#[inline(never)]
fn take_single(call: Call<'_, '_, f32>) -> Ending {
    call.take()
}

#[inline(never)]
fn take_double(call: Call<'_, '_, f64>) -> Ending {
    call.take()
}

impl<'a, 'r, R: Real> Call<'a, 'r, R> {
    fn take(self) -> Ending {
        let Self { model, plan, part, inputs, state, workspace, recorder } = self;
        take_part(model, plan, part, inputs, state, workspace, recorder)
    }

    /// The same call; `P` is the precision that it has.
    fn cast<P: Real>(self) -> Call<'a, 'r, P> {
        let Self { model, plan, part, inputs: Inputs { obstacles, grab, modal_grab }, state, workspace, recorder } =
            self;
        let inputs =
            Inputs { obstacles: downcast(obstacles), grab: grab.map(downcast), modal_grab: modal_grab.map(downcast) };
        let (model, state, workspace) = (downcast(model), downcast_mut(state), downcast_mut(workspace));
        Call { model, plan, part, inputs, state, workspace, recorder }
    }
}

/// A value as what it is.
fn downcast<T: Any, U: Any>(value: &T) -> &U {
    (value as &dyn Any).downcast_ref().expect("`Real` is f32 or f64")
}

/// A value to be changed as what it is.
fn downcast_mut<T: Any, U: Any>(value: &mut T) -> &mut U {
    (value as &mut dyn Any).downcast_mut().expect("`Real` is f32 or f64")
}

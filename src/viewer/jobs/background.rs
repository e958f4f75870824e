//! Work that is too slow for a frame: on a thread of its own, one question at a time, the newest
//! first.

use egui::Context;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Answers questions of one kind.
pub(crate) struct Background<Q, A> {
    answer_to: fn(&Q) -> A,
    /// The last answer, with its question.
    last: Option<(Q, A)>,
    running: Option<(Q, Receiver<A>)>,
    /// The question that ended in a fault: not asked again.
    faulty: Option<Q>,
}

impl<Q: Clone + PartialEq + Send + 'static, A: Send + 'static> Background<Q, A> {
    pub(crate) fn new(answer_to: fn(&Q) -> A) -> Background<Q, A> {
        Background { answer_to, last: None, running: None, faulty: None }
    }

    /// The newest answer there is, and whether it is that to this question. Begins to look for one
    /// if not, as soon as the question before is done with; repaints when it is there.
    pub(crate) fn ask(&mut self, ctx: &Context, question: &Q) -> Option<(&A, bool)> {
        self.poll();
        let known = self.last.as_ref().is_some_and(|(asked, _)| asked == question);
        if !known && self.running.is_none() && self.faulty.as_ref() != Some(question) {
            self.start(ctx, question.clone());
        }
        self.last.as_ref().map(|(_, answer)| (answer, known))
    }

    /// The newest answer so far.
    pub(crate) fn last(&self) -> Option<&A> {
        self.last.as_ref().map(|(_, answer)| answer)
    }

    fn poll(&mut self) {
        let Some((question, result)) = self.running.take() else { return };
        match result.try_recv() {
            Ok(answer) => self.last = Some((question, answer)),
            Err(TryRecvError::Empty) => self.running = Some((question, result)),
            Err(TryRecvError::Disconnected) => self.faulty = Some(question),
        }
    }

    fn start(&mut self, ctx: &Context, question: Q) {
        let (send, result) = channel();
        let (ctx, asked, answer_to) = (ctx.clone(), question.clone(), self.answer_to);
        let thread = std::thread::Builder::new().name("answers".to_owned()).spawn(move || {
            // Nobody listens any more when the window is gone.
            let _ = send.send(answer_to(&asked));
            ctx.request_repaint();
        });
        // Without a thread there is no answer: the next frame tries again.
        self.running = thread.is_ok().then_some((question, result));
    }
}

(** * The Lyapunov function of the attitude law falls

    Sections 3 and 6 of docs/extended-law.md, in exact arithmetic and
    continuous time, for ideal actuators. *)

From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From SaturatedHybrid Require Import Attitude.
Open Scope R_scope.

Section Descent.

Variables (w eta M_t k_t eta_t : R).
Hypothesis w_positive : 0 < w.
Hypothesis eta_between : 0 < eta < 1.

(** U_t as a function of r^2: its derivative there is G. *)
Variable U_t : R -> R.
Hypothesis U_t_slope : forall r_square rest, r_square + rest = 1 -> 0 <= r_square -> 0 <= rest ->
  is_derive U_t r_square (slope M_t k_t eta_t r_square rest).

(** A motion: the lifted error, the error of the body rates, diagonal J. *)
Variables (q_0 q_1 q_2 q_3 e_1 e_2 e_3 : R -> R) (j_1 j_2 j_3 t : R).
Variables (n_1 n_2 n_3 : R).
Hypothesis unit : q_0 t * q_0 t + q_1 t * q_1 t + q_2 t * q_2 t + q_3 t * q_3 t = 1.
Hypothesis lifted : 0 < q_0 t + eta.
(** q' = q (0, omega~) / 2 *)
Hypothesis motion_0 : is_derive q_0 t (- (q_1 t * e_1 t + q_2 t * e_2 t + q_3 t * e_3 t) / 2).
Hypothesis motion_1 : is_derive q_1 t ((q_0 t * e_1 t + q_2 t * e_3 t - q_3 t * e_2 t) / 2).
Hypothesis motion_2 : is_derive q_2 t ((q_0 t * e_2 t + q_3 t * e_1 t - q_1 t * e_3 t) / 2).
Hypothesis motion_3 : is_derive q_3 t ((q_0 t * e_3 t + q_1 t * e_2 t - q_2 t * e_1 t) / 2).
Hypothesis rates_1 : is_derive e_1 t n_1.
Hypothesis rates_2 : is_derive e_2 t n_2.
Hypothesis rates_3 : is_derive e_3 t n_3.

(** The feedback: potential and damping, D_tilt with its share, D_yaw. *)
Variables (d_1 d_2 d_3 : R).
Let P_1 := P_1 w eta M_t k_t eta_t (q_0 t) (q_1 t) (q_2 t) (q_3 t).
Let P_2 := P_2 w eta M_t k_t eta_t (q_0 t) (q_1 t) (q_2 t) (q_3 t).
Let P_3 := P_3 w eta (q_0 t) (q_3 t).
(** What [feed_forward_cancels] leaves of the rigid body. *)
Hypothesis closed_loop :
  e_1 t * (j_1 * n_1) + e_2 t * (j_2 * n_2) + e_3 t * (j_3 * n_3)
  = - (e_1 t * (P_1 + d_1) + e_2 t * (P_2 + d_2) + e_3 t * (P_3 + d_3)).

Definition V (s : R) : R :=
  (j_1 * (e_1 s * e_1 s) + j_2 * (e_2 s * e_2 s) + j_3 * (e_3 s * e_3 s)) / 2
  + w * (1 + eta - distance eta (q_0 s) (q_3 s))
  + U_t (q_1 s * q_1 s + q_2 s * q_2 s).

(** V' = - omega~ . damping: nothing of the potential, of J or of the reference
    is left. *)
Theorem descent : is_derive V t (- (e_1 t * d_1 + e_2 t * d_2 + e_3 t * d_3)).
Proof.
  assert (Hh : 0 < (q_0 t + eta) * (q_0 t + eta) + q_3 t * q_3 t).
  { assert (0 < (q_0 t + eta) * (q_0 t + eta)) by (now apply Rmult_lt_0_compat).
    pose proof (squared (q_3 t)). lra. }
  assert (Hsqrt : 0 < distance eta (q_0 t) (q_3 t)) by (now apply sqrt_lt_R0).
  assert (Hslope := U_t_slope (q_1 t * q_1 t + q_2 t * q_2 t) (q_0 t * q_0 t + q_3 t * q_3 t)
    ltac:(lra) ltac:(pose proof (squared (q_1 t)); pose proof (squared (q_2 t)); lra)
    ltac:(pose proof (squared (q_0 t)); pose proof (squared (q_3 t)); lra)).
  set (G := slope M_t k_t eta_t (q_1 t * q_1 t + q_2 t * q_2 t) (q_0 t * q_0 t + q_3 t * q_3 t)) in *.
  assert (Hkinetic : is_derive
    (fun s => (j_1 * (e_1 s * e_1 s) + j_2 * (e_2 s * e_2 s) + j_3 * (e_3 s * e_3 s)) / 2) t
    (e_1 t * (j_1 * n_1) + e_2 t * (j_2 * n_2) + e_3 t * (j_3 * n_3))).
  { auto_derive.
    - repeat split; try (eexists; eassumption); exact I.
    - rewrite (is_derive_unique (fun x : R => e_1 x) t _ rates_1 : Derive (fun x : R => e_1 x) t = _),
              (is_derive_unique (fun x : R => e_2 x) t _ rates_2 : Derive (fun x : R => e_2 x) t = _),
              (is_derive_unique (fun x : R => e_3 x) t _ rates_3 : Derive (fun x : R => e_3 x) t = _).
      field. }
  assert (Hpull : is_derive (fun s => w * (1 + eta - distance eta (q_0 s) (q_3 s))) t
    (w / (2 * distance eta (q_0 t) (q_3 t)) *
      (((q_0 t + eta) * q_1 t + q_2 t * q_3 t) * e_1 t
       + ((q_0 t + eta) * q_2 t - q_1 t * q_3 t) * e_2 t + eta * q_3 t * e_3 t))).
  { unfold distance in *. auto_derive.
    - repeat split; try (eexists; eassumption); try exact Hh; exact I.
    - rewrite (is_derive_unique (fun x : R => q_0 x) t _ motion_0 : Derive (fun x : R => q_0 x) t = _),
              (is_derive_unique (fun x : R => q_3 x) t _ motion_3 : Derive (fun x : R => q_3 x) t = _).
      field. lra. }
  assert (Hinner : is_derive (fun s => q_1 s * q_1 s + q_2 s * q_2 s) t
    ((q_0 t * q_1 t + q_2 t * q_3 t) * e_1 t + (q_0 t * q_2 t - q_1 t * q_3 t) * e_2 t)).
  { auto_derive.
    - repeat split; try (eexists; eassumption); exact I.
    - rewrite (is_derive_unique (fun x : R => q_1 x) t _ motion_1 : Derive (fun x : R => q_1 x) t = _),
              (is_derive_unique (fun x : R => q_2 x) t _ motion_2 : Derive (fun x : R => q_2 x) t = _).
      field. }
  assert (Houter : is_derive (fun s => U_t (q_1 s * q_1 s + q_2 s * q_2 s)) t
    (scal ((q_0 t * q_1 t + q_2 t * q_3 t) * e_1 t + (q_0 t * q_2 t - q_1 t * q_3 t) * e_2 t) G)).
  { apply (is_derive_comp U_t (fun s => q_1 s * q_1 s + q_2 s * q_2 s)); assumption. }
  unfold V.
  evar_last.
  - apply @is_derive_plus; [apply @is_derive_plus; [exact Hkinetic | exact Hpull] | exact Houter].
  - rewrite closed_loop. unfold P_1, P_2, P_3, Attitude.P_1, Attitude.P_2, Attitude.P_3.
    fold G. unfold plus, scal. cbn. unfold mult. cbn. field. lra.
Qed.

(** With a share of damping that is not negative, V does not rise: for the
    tilt d = lambda c omega~ with lambda and c as in [Damping], for yaw a
    saturation that has the sign of the rate. *)
Theorem no_rise : forall lambda c factor, 0 <= lambda -> 0 <= c -> 0 <= factor ->
  d_1 = lambda * (c * e_1 t) -> d_2 = lambda * (c * e_2 t) -> d_3 = factor * e_3 t ->
  - (e_1 t * d_1 + e_2 t * d_2 + e_3 t * d_3) <= 0.
Proof.
  intros lambda c factor Hl Hc Hf -> -> ->.
  pose proof (squared (e_1 t)). pose proof (squared (e_2 t)). pose proof (squared (e_3 t)).
  assert (0 <= lambda * c) by (now apply Rmult_le_pos).
  assert (0 <= lambda * c * (e_1 t * e_1 t)) by (now apply Rmult_le_pos).
  assert (0 <= lambda * c * (e_2 t * e_2 t)) by (now apply Rmult_le_pos).
  assert (0 <= factor * (e_3 t * e_3 t)) by (now apply Rmult_le_pos). lra.
Qed.

End Descent.

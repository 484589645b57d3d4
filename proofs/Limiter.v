(** * The limiter: how fast the desired frame turns

    Sections 3 and 4 of docs/extended-law.md, in exact arithmetic;
    controller-core/src/extended/turning.rs. *)

From Coq Require Import Reals Lra.
Open Scope R_scope.

(** ** Vectors across the thrust direction *)

Record plane := { x : R; y : R }.

Definition add (u v : plane) : plane := {| x := x u + x v; y := y u + y v |}.
Definition sub (u v : plane) : plane := {| x := x u - x v; y := y u - y v |}.
Definition scaled (k : R) (v : plane) : plane := {| x := k * x v; y := k * y v |}.
Definition square (v : plane) : R := x v * x v + y v * y v.
Definition length (v : plane) : R := sqrt (square v).
(** (p_2, -p_1): by what a frame that turns about rho carries p. *)
Definition quarter (p : plane) : plane := {| x := y p; y := - x p |}.

Lemma square_nonneg : forall v, 0 <= square v.
Proof. intros v. unfold square. nra. Qed.

Lemma length_nonneg : forall v, 0 <= length v.
Proof. intros v. apply sqrt_pos. Qed.

Lemma length_squared : forall v, length v * length v = square v.
Proof. intros v. apply sqrt_def, square_nonneg. Qed.

Lemma length_scaled : forall k v, 0 <= k -> length (scaled k v) = k * length v.
Proof.
  intros k v Hk. unfold length.
  replace (square (scaled k v)) with ((k * k) * square v) by (unfold square, scaled; cbn; ring).
  rewrite sqrt_mult_alt by nra. now rewrite sqrt_square.
Qed.

Lemma triangle : forall u v, length (add u v) <= length u + length v.
Proof.
  intros u v.
  pose proof (length_nonneg u). pose proof (length_nonneg v).
  apply Rsqr_incr_0_var; [|lra]. unfold Rsqr. rewrite length_squared.
  pose proof (length_squared u) as Hu. pose proof (length_squared v) as Hv.
  assert (x u * x v + y u * y v <= length u * length v) as Hcs.
  { apply Rsqr_incr_0_var; [|nra]. unfold Rsqr.
    replace (length u * length v * (length u * length v)) with (square u * square v)
      by (rewrite <- Hu, <- Hv; ring).
    unfold square. pose proof (Rle_0_sqr (x u * y v - y u * x v)) as H1. unfold Rsqr in H1. nra. }
  unfold square, add in *. cbn. nra.
Qed.

(** [shortened v most]: v, at most so long. *)
Definition shortened (v : plane) (most : R) : plane :=
  if Rlt_dec (most * most) (square v) then scaled (most / length v) v else v.

Lemma shortened_length : forall v most, 0 <= most -> length (shortened v most) <= most.
Proof.
  intros v most Hm. unfold shortened. destruct (Rlt_dec (most * most) (square v)) as [H|H].
  - assert (Hpos : 0 < length v).
    { apply sqrt_lt_R0. nra. }
    rewrite length_scaled; [|apply Rmult_le_pos; [lra | left; now apply Rinv_0_lt_compat]].
    right. field. lra.
  - apply Rsqr_incr_0_var; [|exact Hm]. unfold Rsqr. rewrite length_squared. lra.
Qed.

(** A shortened vector is a share of the vector, from zero to one. *)
Lemma shortened_share : forall v most, 0 <= most ->
  exists k, 0 <= k <= 1 /\ x (shortened v most) = k * x v /\ y (shortened v most) = k * y v.
Proof.
  intros v most Hm. unfold shortened. destruct (Rlt_dec (most * most) (square v)) as [H|H].
  - assert (Hpos : 0 < length v) by (apply sqrt_lt_R0; nra).
    exists (most / length v). repeat split.
    + apply Rmult_le_pos; [lra | left; now apply Rinv_0_lt_compat].
    + apply Rmult_le_reg_r with (length v); [exact Hpos|].
      replace (most / length v * length v) with most by (field; lra).
      rewrite Rmult_1_l. apply Rsqr_incr_0_var; [|lra].
      unfold Rsqr. rewrite length_squared. lra.
  - exists 1. repeat split; lra.
Qed.

(** ** One tick *)

Section Tick.

(** p, the wanted q after the first two steps, W, h, Omega, and the greater of
    the budget and the reserve. *)
Variables (rate wanted : plane) (yaw_rate period rate_max most : R).
Hypothesis most_positive : 0 <= most.
Hypothesis rate_max_positive : 0 <= rate_max.
Hypothesis period_positive : 0 < period.

(** Third step: |p + h q| <= Omega. *)
Definition within_rate : plane :=
  scaled (/ period) (sub (shortened (add rate (scaled period wanted)) rate_max) rate).

(** Fourth and last step: |q + W (p_2, -p_1)| <= most. *)
Definition carried : plane := scaled yaw_rate (quarter rate).
Definition limited : plane := sub (shortened (add within_rate carried) most) carried.

Theorem rate_after_third_step : length (add rate (scaled period within_rate)) <= rate_max.
Proof.
  replace (add rate (scaled period within_rate))
    with (shortened (add rate (scaled period wanted)) rate_max).
  - now apply shortened_length.
  - unfold within_rate, add, sub, scaled. cbn.
    destruct (shortened _ _) as [a c]. cbn. f_equal; field; lra.
Qed.

(** Claim (c), first line: the acceleration of the desired frame, exactly. *)
Theorem turning_within_budget : length (add limited carried) <= most.
Proof.
  replace (add limited carried) with (shortened (add within_rate carried) most).
  - now apply shortened_length.
  - unfold limited, add, sub, scaled. cbn.
    destruct (shortened _ _) as [a c]. cbn. f_equal; ring.
Qed.

(** Claim (c), third line, in continuous time: beyond |p| = Omega the third step
    leaves p . q <= 0, and the fourth keeps that sign, since p . (p_2, -p_1) is
    zero. *)
Theorem last_step_does_not_speed_up :
  x rate * x within_rate + y rate * y within_rate <= 0 ->
  x rate * x limited + y rate * y limited <= 0.
Proof.
  unfold limited. generalize within_rate as q. intros q H.
  destruct (shortened_share (add q carried) most most_positive) as (k & Hk & Hx & Hy).
  unfold sub. cbn [x y]. rewrite Hx, Hy. unfold add, carried, scaled, quarter. cbn [x y].
  replace (x rate * (k * (x q + yaw_rate * y rate) - yaw_rate * y rate) +
           y rate * (k * (y q + yaw_rate * - x rate) - yaw_rate * - x rate))
    with (k * (x rate * x q + y rate * y q)) by ring.
  nra.
Qed.

End Tick.

(** ** The budget of a tick pays for it

    Section 4: alpha times its cost t J_max + y J_33 sin is at most what the
    feedback leaves, 0.99 R - t |tau_fb|. So the row holds for the feedback and
    the turning together. Where the cost is zero nothing is divided. *)

Theorem budget_keeps_the_row : forall t y room feedback alpha inertia_tilt inertia_yaw sine,
  alpha * (t * inertia_tilt + y * (inertia_yaw * sine)) <= room - t * feedback ->
  t * (feedback + inertia_tilt * alpha) + y * (inertia_yaw * alpha * sine) <= room.
Proof. intros t y room fb alpha jt jy sine H. lra. Qed.

(** The certificate's reserve row: with all feedback and alpha_0 at a right
    angle the row holds, so alpha_0 is always paid for. *)
Theorem reserve_keeps_the_row : forall t y room feedback feedback_max reserve inertia_tilt inertia_yaw sine,
  0 <= t -> 0 <= y -> 0 <= inertia_tilt -> 0 <= inertia_yaw -> 0 <= sine <= 1 -> 0 <= reserve ->
  feedback <= feedback_max ->
  t * (feedback_max + inertia_tilt * reserve) + y * inertia_yaw * reserve <= room ->
  t * (feedback + inertia_tilt * reserve) + y * (inertia_yaw * reserve * sine) <= room.
Proof.
  intros t y room fb fb_max reserve jt jy sine Ht Hy Hjt Hjy Hs Hr Hfb H.
  assert (y * (jy * reserve * sine) <= y * jy * reserve).
  { replace (y * (jy * reserve * sine)) with (y * jy * reserve * sine) by ring.
    rewrite <- (Rmult_1_r (y * jy * reserve)) at 2.
    apply Rmult_le_compat_l; [|lra]. apply Rmult_le_pos; [|exact Hr]. now apply Rmult_le_pos. }
  assert (t * fb <= t * fb_max) by (apply Rmult_le_compat_l; lra).
  lra.
Qed.

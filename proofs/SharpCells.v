(** * The sharp bound over a cell

    docs/sharp-bound.md, step 6; [Tilt], [Direction], [HeadingCell], [Shares] and
    their functions in controller-core/src/certificate/sharp.rs, with the same
    names. Each quantity is taken at the end of its range where it is worst:
    every part of the bound grows with it. [SharpCover] has the cells cover
    everything. *)

From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From SaturatedHybrid Require Import Space Direction DesiredFrame ExactRates Slope SharpBound SharpMotion.
Open Scope R_scope.

(** ** Every part grows *)

Ltac nonneg := repeat first [lra | apply squared | apply Rplus_le_le_0_compat | apply Rmult_le_pos].
Ltac grow := repeat first [lra | solve [nonneg] | apply Rplus_le_compat | apply Rmult_le_compat].

Theorem yaw_bound_grows : forall tan tan' secant secant' rate rate' mixed mixed',
  0 <= tan <= tan' -> 0 <= secant <= secant' -> 0 <= rate <= rate' -> 0 <= mixed <= mixed' ->
  0 <= yaw_bound tan secant rate mixed <= yaw_bound tan' secant' rate' mixed'.
Proof. intros. unfold yaw_bound. split; [nonneg | grow]. Qed.

Theorem tilting_bound_grows : forall tan tan' secant secant' rate rate' length length' product product' mixed mixed',
  0 <= tan <= tan' -> 0 <= secant <= secant' -> 0 <= rate <= rate' -> 0 <= length <= length' ->
  0 <= product <= product' -> 0 <= mixed <= mixed' ->
  0 <= tilting_bound tan secant rate length product mixed <= tilting_bound tan' secant' rate' length' product' mixed'.
Proof.
  intros tan tan' secant secant' rate rate' length length' product product' mixed mixed' Ht Hs Hr Hl Hp Hm.
  split; [apply sqrt_pos|]. apply sqrt_le_1_alt.
  pose proof (yaw_bound_grows _ _ _ _ _ _ _ _ Ht Hs Hr Hm) as Hy.
  set (a := yaw_bound tan secant rate mixed) in *. set (b := yaw_bound tan' secant' rate' mixed') in *. grow.
Qed.

Theorem yawing_bound_grows : forall tan tan' sine sine' secant secant' rate rate' acceleration acceleration'
    stretch stretch' length length' mixed mixed',
  0 <= tan <= tan' -> 0 <= sine <= sine' -> 0 <= secant <= secant' -> 0 <= rate <= rate' ->
  0 <= acceleration <= acceleration' -> 0 <= stretch <= stretch' -> 0 <= length <= length' ->
  0 <= mixed <= mixed' ->
  0 <= yawing_bound tan sine secant rate acceleration stretch length mixed
    <= yawing_bound tan' sine' secant' rate' acceleration' stretch' length' mixed'.
Proof. intros. unfold yawing_bound, Rdiv. split; [nonneg | grow]. Qed.

(** ** The functions of sharp.rs *)

Section Cell.

(** A cell of tan gamma, and z = g - M_p - K_a3. *)
Variables (near far vertical_least : R).

Definition secant : R := sqrt (1 + far * far).
Definition secant_least : R := sqrt (1 + near * near).
Definition tilt_sin : R := far / secant.
Definition sin_least : R := near / secant_least.
Definition cos_greatest : R := 1 / secant_least.
Definition magnitude : R := vertical_least * secant_least.

(** A vector's part orthogonal to rho: its horizontal part at most so long and
    within a cell of directions, its vertical part at most so long. *)
Definition tangential_square (horizontal vertical direction_cos_greatest direction_cos_least : R) : R :=
  horizontal * horizontal + tilt_sin * vertical * (tilt_sin * vertical)
  - sin_least * horizontal * direction_cos_least * (sin_least * horizontal * direction_cos_least)
  + 2 * cos_greatest * horizontal * direction_cos_greatest * (tilt_sin * vertical).
Definition tangential_length (horizontal vertical direction_cos_greatest direction_cos_least : R) : R :=
  sqrt (tangential_square horizontal vertical direction_cos_greatest direction_cos_least) / magnitude.
Definition tangential_mixed (horizontal vertical direction_cos_greatest direction_cos_least direction_sin : R) : R :=
  (tangential_length horizontal vertical direction_cos_greatest direction_cos_least
   + horizontal * direction_sin / magnitude) / 2.

(** The shares of u', |u'| <= jerk, for p from [least] to [most]. *)
Definition greatest_product (total least most : R) : R :=
  let x := Rmin (Rmax (total / 2) least) most in sqrt (x * (total - x)).
Definition share_stretch (jerk least : R) : R := sqrt (jerk * jerk - least * least) / magnitude.
Definition share_product (jerk least most : R) : R :=
  greatest_product (jerk * jerk) (least * least) (most * most) / (magnitude * magnitude).
Definition share_mixed (horizontal_jerk most : R) : R := (most / magnitude + Rmin most horizontal_jerk / magnitude) / 2.
(** |psi''| in a cell of |psi'|. *)
Definition heading_acceleration (second_bound near_rate : R) : R :=
  sqrt (second_bound * second_bound - near_rate * near_rate * near_rate * near_rate).

(** |omega_d|^2 and |omega_d'|^2 at most. *)
Definition velocity_square (jerk_length jerk_mixed rate : R) : R :=
  jerk_length * jerk_length + yaw_bound far secant rate jerk_mixed * yaw_bound far secant rate jerk_mixed.
Definition acceleration_square (snap_length snap_mixed rate acceleration jerk horizontal_jerk least most : R) : R :=
  square_of_sum snap_length (far * snap_mixed)
    (tilting_bound far secant rate (most / magnitude) (share_product jerk least most) (share_mixed horizontal_jerk
      most))
    (yawing_bound far tilt_sin secant rate acceleration (share_stretch jerk least) (most / magnitude)
       (share_mixed horizontal_jerk most)).

(** p r is greatest in the middle. *)
Lemma product_within : forall total least most q, least <= q <= most -> 0 <= q <= total ->
  sqrt (q * (total - q)) <= greatest_product total least most.
Proof.
  intros total least most q Hq Ht. unfold greatest_product. apply sqrt_le_1_alt.
  assert (Hmid : q * (total - q) <= total / 2 * (total - total / 2)).
  { pose proof (squared (q - total / 2)). lra. }
  unfold Rmax, Rmin. destruct (Rle_dec (total / 2) least) as [H1|H1].
  - destruct (Rle_dec least most) as [H2|H2]; [|lra].
    assert (0 <= (q - least) * (q + least - total)) by (apply Rmult_le_pos; lra). lra.
  - destruct (Rle_dec (total / 2) most) as [H2|H2]; [exact Hmid|].
    assert (0 <= (most - q) * (total - q - most)) by (apply Rmult_le_pos; lra). lra.
Qed.

Section Inside.

(** A tilt of the cell, and what the cell makes of it. *)
Variables (cosine sine : R).
Hypothesis on_circle : cosine * cosine + sine * sine = 1.
Hypothesis not_flat : 0 < cosine /\ 0 <= sine.
Hypothesis in_cell : 0 <= near /\ near <= tangent cosine sine <= far.
Hypothesis vertical_positive : 0 < vertical_least.

Lemma grows_with_tangent : forall a b, 0 <= a <= b -> a / sqrt (1 + a * a) <= b / sqrt (1 + b * b).
Proof.
  intros a b Hab. assert (Ha : 0 < 1 + a * a) by (pose proof (squared a); lra).
  assert (Hb : 0 < 1 + b * b) by (pose proof (squared b); lra).
  pose proof (sqrt_lt_R0 _ Ha) as Ra. pose proof (sqrt_lt_R0 _ Hb) as Rb.
  pose proof (sqrt_def _ (Rlt_le _ _ Ha)) as Sa. pose proof (sqrt_def _ (Rlt_le _ _ Hb)) as Sb.
  set (p := sqrt (1 + a * a)) in *. set (q := sqrt (1 + b * b)) in *.
  apply Rmult_le_reg_r with (p * q); [now apply Rmult_lt_0_compat|].
  replace (a / p * (p * q)) with (a * q) by (field; lra). replace (b / q * (p * q)) with (b * p) by (field; lra).
  apply below_by_squares; [apply Rmult_le_pos; lra|].
  replace (a * q * (a * q)) with (a * a * (q * q)) by ring. replace (b * p * (b * p)) with (b * b * (p * p)) by ring.
  rewrite Sa, Sb. pose proof (squares_below a b ltac:(lra) ltac:(lra)). lra.
Qed.

Lemma tilt_of_tangent : / cosine = sqrt (1 + tangent cosine sine * tangent cosine sine) /\
  sine = tangent cosine sine / sqrt (1 + tangent cosine sine * tangent cosine sine).
Proof.
  assert (E : / cosine = sqrt (1 + tangent cosine sine * tangent cosine sine)).
  { rewrite <- (sqrt_square (/ cosine)) by (left; apply Rinv_0_lt_compat; lra). f_equal. unfold tangent.
    replace (1 + sine / cosine * (sine / cosine)) with ((cosine * cosine + sine * sine) * (/ cosine * / cosine))
      by (field; lra). rewrite on_circle. ring. }
  split; [exact E|]. rewrite <- E. unfold tangent. field. lra.
Qed.

Lemma tilt_in_cell : / cosine <= secant /\ sin_least <= sine <= tilt_sin /\ cosine <= cos_greatest /\
  0 < magnitude /\ 0 <= sin_least /\ forall n, vertical_least <= n * cosine -> magnitude <= n.
Proof.
  destruct tilt_of_tangent as (E1 & E2). destruct in_cell as (Hnear & Hcell).
  assert (Hsec : 0 < secant_least) by (apply sqrt_lt_R0; pose proof (squared near); lra).
  assert (Hlow : secant_least <= / cosine).
  { rewrite E1. apply sqrt_le_1_alt. apply Rplus_le_compat_l. apply squares_below; lra. }
  assert (Hc : 0 < / cosine) by (apply Rinv_0_lt_compat; lra).
  split; [|split; [|split; [|split; [|split]]]].
  - rewrite E1. apply sqrt_le_1_alt. apply Rplus_le_compat_l. apply squares_below; lra.
  - rewrite E2. split; apply grows_with_tangent; lra.
  - unfold cos_greatest. replace cosine with (1 / / cosine) by (field; lra).
    unfold Rdiv. apply Rmult_le_compat_l; [lra|]. now apply Rinv_le_contravar.
  - now apply Rmult_lt_0_compat.
  - apply Rmult_le_pos; [exact Hnear | left; now apply Rinv_0_lt_compat].
  - intros n Hn. unfold magnitude. replace n with (n * cosine * / cosine) by (field; lra).
    apply Rmult_le_compat; lra.
Qed.

(** |v|^2 of the part orthogonal to rho, for its horizontal part h at the angle
    a to the slope and its vertical part c, grows with all it is made of. *)
Lemma tangential_within : forall h a_cos a_sin c horizontal vertical d_greatest d_least,
  a_cos * a_cos + a_sin * a_sin = 1 -> 0 <= h <= horizontal -> Rabs c <= vertical ->
  0 <= d_least -> d_least <= Rabs a_cos <= d_greatest ->
  h * h + c * c - (sine * h * a_cos + cosine * c) * (sine * h * a_cos + cosine * c)
  <= tangential_square horizontal vertical d_greatest d_least.
Proof.
  intros h a s c H V dg dl Ha Hh Hv Hdl Hd. destruct tilt_in_cell as (_ & Hs & Hc & _ & Hs0 & _).
  assert (Haa : Rabs a * Rabs a = a * a) by (rewrite <- Rabs_mult; apply Rabs_pos_eq, squared).
  assert (Hcc : Rabs c * Rabs c = c * c) by (rewrite <- Rabs_mult; apply Rabs_pos_eq, squared).
  pose proof (Rabs_pos a) as Ha0. pose proof (Rabs_pos c) as Hc0.
  assert (Hone : 0 <= 1 - sine * sine * (a * a)).
  { pose proof (squared cosine). pose proof (squared s). pose proof (squared a).
    assert (sine * sine * (a * a) <= 1 * 1) by (apply Rmult_le_compat; try apply squared; lra). lra. }
  apply Rle_trans with (h * h * (1 - sine * sine * (a * a)) + sine * sine * (c * c)
    + 2 * (cosine * h * Rabs a * (sine * Rabs c))).
  { assert (Hcross : - (a * c) <= Rabs a * Rabs c) by (rewrite <- Rabs_mult, <- Rabs_Ropp; apply Rle_abs).
    assert (0 <= sine * cosine * h) by (repeat apply Rmult_le_pos; lra).
    assert (sine * cosine * h * - (a * c) <= sine * cosine * h * (Rabs a * Rabs c)) by (apply Rmult_le_compat_l; lra).
    assert (E : c * c - cosine * cosine * (c * c) = sine * sine * (c * c)).
    { transitivity ((1 - cosine * cosine) * (c * c)); [ring|]. rewrite <- on_circle. ring. }
    lra. }
  apply Rle_trans with (H * H * (1 - sine * sine * (a * a)) + tilt_sin * V * (tilt_sin * V)
    + 2 * (cos_greatest * H * dg * (tilt_sin * V))).
  { assert (H1 : h * h * (1 - sine * sine * (a * a)) <= H * H * (1 - sine * sine * (a * a)))
      by (apply Rmult_le_compat_r; [exact Hone | apply squares_below; lra]).
    assert (H2 : sine * Rabs c <= tilt_sin * V) by (apply Rmult_le_compat; lra).
    assert (H2p : 0 <= sine * Rabs c) by (apply Rmult_le_pos; lra).
    assert (H3 : sine * sine * (c * c) <= tilt_sin * V * (tilt_sin * V)).
    { rewrite <- Hcc. replace (sine * sine * (Rabs c * Rabs c)) with (sine * Rabs c * (sine * Rabs c)) by ring.
      now apply squares_below. }
    assert (H4 : cosine * h * Rabs a * (sine * Rabs c) <= cos_greatest * H * dg * (tilt_sin * V)).
    { apply Rmult_le_compat; [repeat apply Rmult_le_pos; lra | exact H2p | | exact H2].
      apply Rmult_le_compat; [repeat apply Rmult_le_pos; lra | lra | | lra].
      apply Rmult_le_compat; lra. }
    lra. }
  assert (H5 : sin_least * H * dl * (sin_least * H * dl) <= H * H * (sine * sine * (a * a))).
  { rewrite <- Haa. replace (H * H * (sine * sine * (Rabs a * Rabs a))) with (sine * H * Rabs a * (sine * H * Rabs
    a)) by ring.
    assert (Hsh : 0 <= sin_least * H <= sine * H).
    { split; [apply Rmult_le_pos; lra | apply Rmult_le_compat_r; lra]. }
    apply squares_below; [apply Rmult_le_pos; lra | apply Rmult_le_compat; lra]. }
  unfold tangential_square. lra.
Qed.

End Inside.
End Cell.

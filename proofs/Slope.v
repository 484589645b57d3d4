(** * Vectors across the thrust direction, against the slope

    Lengths in the plane across rho, and what step 4 of docs/sharp-bound.md says
    of [v] = (|v| + |v_perp|) / 2, controller-core/src/certificate/sharp.rs: it is
    the greatest that sin chi times the body x component of v can be, where chi
    is the angle from body x to the uphill direction. *)

From Coq Require Import Reals Lra.
From SaturatedHybrid Require Import Space.
Open Scope R_scope.

Definition plane_length (v_x v_y : R) : R := sqrt (v_x * v_x + v_y * v_y).

Lemma plane_length_nonneg : forall a b, 0 <= plane_length a b.
Proof. intros. apply sqrt_pos. Qed.

Lemma plane_length_squared : forall a b, plane_length a b * plane_length a b = a * a + b * b.
Proof. intros. apply sqrt_def. pose proof (squared a). pose proof (squared b). lra. Qed.

Lemma plane_cauchy_schwarz : forall a b c d, Rabs (a * c + b * d) <= plane_length a b * plane_length c d.
Proof.
  intros. pose proof (plane_length_nonneg a b). pose proof (plane_length_nonneg c d).
  apply below_by_squares; [now apply Rmult_le_pos|].
  replace (Rabs (a * c + b * d) * Rabs (a * c + b * d)) with ((a * c + b * d) * (a * c + b * d))
    by (rewrite <- Rabs_mult; symmetry; apply Rabs_pos_eq, squared).
  replace (plane_length a b * plane_length c d * (plane_length a b * plane_length c d))
    with ((a * a + b * b) * (c * c + d * d)) by (rewrite <- !plane_length_squared; ring).
  pose proof (squared (a * d - b * c)). lra.
Qed.

Lemma plane_triangle : forall a b c d, plane_length (a + c) (b + d) <= plane_length a b + plane_length c d.
Proof.
  intros. pose proof (plane_length_nonneg a b). pose proof (plane_length_nonneg c d).
  apply below_by_squares; [lra|]. pose proof (plane_cauchy_schwarz a b c d) as H1.
  pose proof (Rle_abs (a * c + b * d)).
  pose proof (plane_length_squared a b). pose proof (plane_length_squared c d). rewrite plane_length_squared. lra.
Qed.

Lemma plane_length_over : forall a b n, 0 < n -> plane_length (a / n) (b / n) = plane_length a b / n.
Proof.
  intros a b n Hn. assert (Hi : 0 < / n) by (now apply Rinv_0_lt_compat). unfold plane_length.
  replace (a / n * (a / n) + b / n * (b / n)) with ((a * a + b * b) * (/ n * / n)) by (field; lra).
  pose proof (squared a). pose proof (squared b).
  rewrite sqrt_mult_alt by lra. rewrite sqrt_square by lra. reflexivity.
Qed.

(** max over chi of sin chi (x . v) = (|v| + |v_perp|) / 2: the angle that step 4
    takes the supremum over reaches it. *)
Theorem mixed_is_reached : forall parallel perp, exists cosine sine,
  cosine * cosine + sine * sine = 1 /\
  Rabs (sine * (parallel * cosine - perp * sine)) = (plane_length parallel perp + Rabs perp) / 2.
Proof.
  intros a b. pose proof (plane_length_nonneg a b) as Hn. pose proof (plane_length_squared a b) as Hnn.
  set (n := plane_length a b) in *. pose proof (squared a). pose proof (squared b).
  destruct (Req_dec n 0) as [Hz|Hz].
  - exists 1, 0. rewrite Hz in *. assert (b = 0).
    { destruct (Rmult_integral b b); [lra | assumption | assumption]. }
    subst b. rewrite Rabs_R0. split; [ring|]. replace (0 * (a * 1 - 0 * 0)) with 0 by ring. rewrite Rabs_R0. field.
  - assert (Hsign : exists g, g * g = 1 /\ Rabs b = g * b).
    { unfold Rabs. destruct (Rcase_abs b); [exists (-1) | exists 1]; split; ring. }
    destruct Hsign as (g & Hg & Hb). pose proof (Rabs_pos b) as Hb0.
    set (s := sqrt ((1 + Rabs b / n) / 2)).
    assert (Hq : 0 <= Rabs b / n) by (apply Rmult_le_pos; [exact Hb0 | left; apply Rinv_0_lt_compat; lra]).
    assert (Hs : 0 < s) by (apply sqrt_lt_R0; lra).
    assert (Hss : s * s = (1 + Rabs b / n) / 2) by (apply sqrt_def; lra).
    exists (- g * a / (2 * n * s)), s. split.
    + replace (- g * a / (2 * n * s) * (- g * a / (2 * n * s)))
        with (g * g * (a * a) / (4 * (n * n) * (s * s))) by (field; lra).
      rewrite Hg. apply Rmult_eq_reg_r with (4 * (n * n) * (s * s)); [|assert (0 < n * n) by nra; nra].
      replace ((1 * (a * a) / (4 * (n * n) * (s * s)) + s * s) * (4 * (n * n) * (s * s)))
        with (a * a + (2 * n * (s * s)) * (2 * n * (s * s))) by (field; lra).
      assert (E : 2 * n * (s * s) = n + Rabs b) by (rewrite Hss; field; lra).
      replace (1 * (4 * (n * n) * (s * s))) with (2 * n * (2 * n * (s * s))) by ring.
      rewrite E. assert (Rabs b * Rabs b = b * b) by (rewrite <- Rabs_mult; apply Rabs_pos_eq, squared). lra.
    + replace (s * (a * (- g * a / (2 * n * s)) - b * s)) with (- (g * (a * a) / (2 * n) + b * (s * s))) by (field;
      lra).
      assert (E : g * (a * a) / (2 * n) + b * (s * s) = g * ((n + Rabs b) / 2)).
      { rewrite Hss. replace b with (g * Rabs b) at 1 by (rewrite Hb, <- Rmult_assoc, Hg; ring).
        assert (E2 : Rabs b * Rabs b = b * b) by (rewrite <- Rabs_mult; apply Rabs_pos_eq, squared).
        replace (a * a) with (n * n - Rabs b * Rabs b) by lra. field. lra. }
      assert (Hg1 : Rabs g = 1).
      { unfold Rabs. destruct (Rcase_abs g); nra. }
      rewrite E, Rabs_Ropp, Rabs_mult, Hg1, Rabs_pos_eq by lra. ring.
Qed.

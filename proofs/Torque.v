(** * Theorem 2's torque bound

    The paper's attitude law, in exact arithmetic;
    controller-core/src/attitude.rs and controller-core/src/certificate. For
    the bounds U and U' of Lemma 1 on |omega_d| and |omega_d'|. *)

From Coq Require Import Reals Lra.
Open Scope R_scope.

Definition square (x y z : R) : R := x * x + y * y + z * z.

Lemma square_nonneg : forall x y z, 0 <= square x y z.
Proof.
  intros. unfold square. pose proof (Rle_0_sqr x). pose proof (Rle_0_sqr y). pose proof (Rle_0_sqr z).
  unfold Rsqr in *. lra.
Qed.

Lemma component_below_length : forall x y z, Rabs x <= sqrt (square x y z).
Proof.
  intros. rewrite <- sqrt_Rsqr_abs. apply sqrt_le_1_alt. unfold square, Rsqr.
  pose proof (Rle_0_sqr y). pose proof (Rle_0_sqr z). unfold Rsqr in *. lra.
Qed.

(** s(x) = M k x / sqrt (M^2 + |k x|^2): a component, for |x|^2. *)
Definition saturated (M k component whole : R) : R := M * k * component / sqrt (M * M + k * k * whole).

Theorem saturation_level : forall M k x y z, 0 < M -> 0 < k ->
  sqrt (square (saturated M k x (square x y z)) (saturated M k y (square x y z)) (saturated M k z (square x y z))) < M.
Proof.
  intros M k x y z HM Hk.
  pose proof (square_nonneg x y z) as Hs.
  assert (HMM : 0 < M * M) by (now apply Rmult_lt_0_compat).
  assert (Hkk : 0 <= k * k * square x y z) by (apply Rmult_le_pos; [apply Rle_0_sqr | exact Hs]).
  assert (Hroot : 0 < sqrt (M * M + k * k * square x y z)) by (apply sqrt_lt_R0; lra).
  assert (Hrr : sqrt (M * M + k * k * square x y z) * sqrt (M * M + k * k * square x y z) = M * M + k * k * square x
    y z)
    by (apply sqrt_def; lra).
  apply Rlt_le_trans with (sqrt (M * M)); [|right; apply sqrt_square; lra]. apply sqrt_lt_1_alt. split;
    [apply square_nonneg|].
  unfold saturated.
  remember (sqrt (M * M + k * k * square x y z)) as root eqn:E. clear E.
  assert (Hform : square (M * k * x / root) (M * k * y / root) (M * k * z / root)
    = M * M * (k * k * square x y z) / (root * root)) by (unfold square; field; lra).
  rewrite Hform, Hrr.
  apply Rmult_lt_reg_r with (M * M + k * k * square x y z); [lra|].
  replace (M * M * (k * k * square x y z) / (M * M + k * k * square x y z) * (M * M + k * k * square x y z))
    with (M * M * (k * k * square x y z)) by (field; lra).
  assert (0 < M * M * (M * M)) by (now apply Rmult_lt_0_compat). lra.
Qed.

(** iota: the feedback's greatest torque, with |theta~| <= 1 + delta. *)
Definition iota (M_theta M_omega delta : R) : R := (1 + (1 + delta) * (1 + delta)) / 4 * M_theta + M_omega.

Definition torque_max (j j_next j_last U U_1 M_theta M_omega delta : R) : R :=
  j * U_1 + Rabs (j_next - j_last) * (U * U) / 2 + iota M_theta M_omega delta.

(** One axis of tau = J a + (difference of J) r r - (1 + |theta~|^2)/4 s_theta - s_omega; the others go round. *)
Theorem torque_bound : forall j j_next j_last U U_1 M_theta M_omega delta
    theta_square s_theta s_omega r_1 r_2 r_3 a_1 a_2 a_3,
  0 <= j -> 0 < delta -> 0 <= U_1 ->
  0 <= theta_square <= (1 + delta) * (1 + delta) ->
  Rabs s_theta <= M_theta -> Rabs s_omega <= M_omega ->
  square r_1 r_2 r_3 <= U * U -> square a_1 a_2 a_3 <= U_1 * U_1 ->
  Rabs (j * a_1 + (j_last - j_next) * r_2 * r_3 - (1 + theta_square) / 4 * s_theta - s_omega)
  <= torque_max j j_next j_last U U_1 M_theta M_omega delta.
Proof.
  intros j j_n j_l U U_1 M_t M_o delta th s_t s_o r_1 r_2 r_3 a_1 a_2 a_3 Hj Hd HU Hth Hst Hso Hr Ha.
  assert (Hacc : Rabs (j * a_1) <= j * U_1).
  { rewrite Rabs_mult, (Rabs_pos_eq j) by exact Hj. apply Rmult_le_compat_l; [exact Hj|].
    eapply Rle_trans; [apply (component_below_length a_1 a_2 a_3)|].
    rewrite <- (sqrt_square U_1) by exact HU. now apply sqrt_le_1_alt. }
  assert (Hprod : Rabs (r_2 * r_3) <= U * U / 2).
  { unfold square in Hr. pose proof (Rle_0_sqr r_1) as H1. pose proof (Rle_0_sqr (r_2 - r_3)) as H2.
    pose proof (Rle_0_sqr (r_2 + r_3)) as H3. unfold Rsqr in *. unfold Rabs. destruct (Rcase_abs (r_2 * r_3)); lra. }
  assert (Hgyro : Rabs ((j_l - j_n) * r_2 * r_3) <= Rabs (j_n - j_l) * (U * U) / 2).
  { rewrite Rmult_assoc, Rabs_mult, (Rabs_minus_sym j_l j_n).
    replace (Rabs (j_n - j_l) * (U * U) / 2) with (Rabs (j_n - j_l) * (U * U / 2)) by field.
    apply Rmult_le_compat_l; [apply Rabs_pos | exact Hprod]. }
  assert (Hfeedback : Rabs ((1 + th) / 4 * s_t) <= (1 + (1 + delta) * (1 + delta)) / 4 * M_t).
  { rewrite Rabs_mult, (Rabs_pos_eq ((1 + th) / 4)) by lra.
    apply Rmult_le_compat; try apply Rabs_pos; lra. }
  unfold torque_max, iota.
  assert (Hb : forall x c, Rabs x <= c -> - c <= x <= c).
  { intros x c H. unfold Rabs in H. destruct (Rcase_abs x); lra. }
  apply Hb in Hacc. apply Hb in Hgyro. apply Hb in Hfeedback. apply Hb in Hso.
  apply Rabs_le. lra.
Qed.
